// Faces: pairs that touch in three or four points of a plane. Where nothing else touches in an island, they are solved
// at once.
#pragma once

#include <tumble/contact/contact_rows.hpp>

namespace tumble {

// Sweeps over points go through them in an order. Of a face that lands flat they leave a part of the fall at some
// corners, and so a stack that is set down would turn and walk off its axis, although it is its own mirror image. In a
// heap most pairs carry at an edge or at single points: there, points are enough.
template <class N, Spin spin, Features features>
class Faces {
public:
    using Rows = ContactRows<N, spin, features>;
    using C = typename Rows::C;
    using Unit = typename Rows::Unit;
    using Length = typename Rows::Length;
    using Speed = typename Rows::Speed;
    using NarrowPhase = typename Rows::NarrowPhase;
    using Pair = typename Rows::Pair;
    using PairList = typename Rows::PairList;
    using Island = typename Rows::Island;
    using Work = typename N::Work;
    static constexpr bool exist = Pair::has_faces;

    Faces(const NarrowPhase& shapes, PairList& pairs, const Island& island, const Rows& rows)
        : shapes_{shapes}, pairs_{pairs}, island_{island}, rows_{rows} {}

    // Makes the modes of all pairs with points. False where one of them is no face, or its points want what no motion
    // of its bodies gives them. The points' rows and targets must be set.
    [[nodiscard]] bool make() const {
        bool all = exist;
        if constexpr (exist) {
            for_each([&](const Pair& pair) { all = all && pair.count > 2; });
            if (all) for_each([&](Pair& pair) { all = all && make(pair); });
        }
        return all;
    }
    // Sets the targets anew from those of the points. What they do not fit is solved by its points.
    void set_targets() const {
        if constexpr (exist) for_each([&](Pair& pair) { set_targets(pair); });
    }

private:
    template <class F>
    void for_each(F&& f) const {
        pairs_.for_each(island_, [&](Pair& pair) {
            if (pair.count > 0) f(pair);
        });
    }
    [[nodiscard]] bool make(Pair& pair) const requires exist {
        auto& face = pair.face;
        typename decltype(face.normals)::Places places;
        face.whole =
            find_places(pair, places) && face.normals.make(normals_of(pair), places, pair.count, pair.moves_b());
        set_targets(pair);
        if constexpr (features.friction) {
            face.has_tangents = false;
            if (!face.whole || pair.rows() == 1 || pair.resists_spin()) return face.whole;
            // Two ways and a turn, of which each point has its part.
            typename decltype(face.tangents)::Places across;
            for (int i = 0; i < pair.count; ++i) {
                across[2 * i][0] = across[2 * i + 1][1] = places[i][0];
                across[2 * i][1] = across[2 * i + 1][0] = Unit{};
                across[2 * i][2] = -C::half(places[i][2]);
                across[2 * i + 1][2] = C::half(places[i][1]);
            }
            const auto tangent = [&](int i) -> const auto& { return pair.point[i / 2].row[1 + i % 2]; };
            face.has_tangents = face.tangents.make(tangent, across, 2 * pair.count, pair.moves_b());
            if (face.has_tangents) face.tangents.set_targets(tangent, 2 * pair.count);
        }
        return face.whole;
    }
    void set_targets(Pair& pair) const requires exist {
        auto& face = pair.face;
        if (!face.whole) return;
        const auto normal = normals_of(pair);
        face.normals.set_targets(normal, pair.count);
        const Speed least =
            rows_.pair_speed(pair, shapes_.scale().metres(ContactBounds<N>::resting_depth(shapes_.tolerance())));
        for (int i = 0; pair.count > 3 && i < pair.count; ++i)
            face.whole =
                face.whole && !(face.normals.missed(normal(i), pair.moves_b()) > Rows::along(pair.point[i], least));
    }
    [[nodiscard]] static auto normals_of(const Pair& pair) {
        return [&](int i) -> const auto& { return pair.point[i].row[0]; };
    }
    // A quarter, and the coordinates of the points from their mean along the tangents, times a power of two that makes
    // the largest a quarter at most. False where all points are at one place.
    [[nodiscard]] bool find_places(const Pair& pair, Unit (&places)[Pair::max_points][3]) const {
        StoredVec3<Unit> tangent[2] = {pair.tangent[0], pair.tangent[1]};
        if (pair.rows() == 1) set_tangents<N>(pair.normal, tangent);
        const Unit part = C::unit(Work(1) / Work(pair.count));
        Length from_mean[2][Pair::max_points], largest{};
        for (int k = 0; k < 2; ++k) {
            const Vec3<Unit> along = shapes_.axes(pair.a).to_body(Vec3<Unit>(tangent[k]));
            Length mean{};
            for (int i = 0; i < pair.count; ++i) {
                from_mean[k][i] = narrow<Length>(dot(along, pair.point[i].arm));
                mean += narrow<Length>(mul(part, from_mean[k][i]));
            }
            for (Length* l = from_mean[k]; l != from_mean[k] + pair.count; ++l) {
                *l -= mean;
                if (magnitude_of(*l) > largest) largest = magnitude_of(*l);
            }
        }
        if (!(largest > Length{})) return false;
        const int log2 = C::to_quarter(largest);
        for (int i = 0; i < pair.count; ++i) {
            places[i][0] = C::half(C::half(C::one()));
            for (int k = 0; k < 2; ++k) places[i][k + 1] = C::times_power(from_mean[k][i], log2);
        }
        return true;
    }

    const NarrowPhase& shapes_;
    PairList& pairs_;
    const Island& island_;
    const Rows& rows_;
};

}  // namespace tumble

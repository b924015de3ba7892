// The contacts of an island of many bodies, solved at once for a whole step by a bounded number of sweeps.
#pragma once

#include <tumble/contact/faces.hpp>
#include <tumble/contact/resting.hpp>

namespace tumble {

// No point is below its surface at the end of the step, along the row that it has at the start (speculative contacts,
// Catto 2013). The bodies move by the velocities u of that end, so contacts that change them by P change the energy by
// u . P - |u - u0|^2 / 2, with the velocities u0 of the start, whatever their rows and however many sweeps they had.
// Surfaces that move give energy, too: impulses times their velocities. This is no gain.
template <class N, Spin spin, Features features>
class BoundedSolver {
public:
    using Rows = ContactRows<N, spin, features>;
    using C = typename Rows::C;
    using Bounds = ContactBounds<N>;
    using Unit = typename Rows::Unit;
    using Length = typename Rows::Length;
    using Speed = typename Rows::Speed;
    using Work = typename N::Work;
    using NarrowPhase = typename Rows::NarrowPhase;
    using Pair = typename Rows::Pair;
    using Point = typename Rows::Point;
    using PairList = typename Rows::PairList;
    using Island = typename Rows::Island;
    using Velocities = typename Rows::Velocities;
    using Velocity = typename Rows::Velocity;
    using Kicks = typename Rows::Kicks;

    // `threshold`: of restitution, m a step. `halvings`: of the step, of which a part is solved.
    BoundedSolver(const NarrowPhase& shapes, PairList& pairs, Velocities& velocities, typename NarrowPhase::Bodies& all,
                  const Island& island, Work threshold, int halvings)
        : shapes_{shapes}, pairs_{pairs}, velocities_{velocities}, bodies_{all}, island_{island},
          rows_{shapes, pairs, velocities, all, island}, threshold_{threshold}, halvings_{halvings} {}

    // What contacts have changed in the step, against what loads have.
    struct Changes {
        bool trembles = false;         // each body changes by less than half of what loads alone would change
        bool glides = false;           // all that touches slides as it did, under constant forces
        bool exceed[features.bodies];  // the bounds on the time to contact do not allow for the change of the velocity

        [[nodiscard]] bool any_exceeds(const auto& group) const {
            bool any = false;
            for (int k = 0; k < group.count; ++k) any = any || exceed[group.id[k]];
            return any;
        }
    };
    // Whether an overlap is to be corrected.
    [[nodiscard]] bool overlap() const {
        return pairs_.any_gap(island_, [&](Length gap) { return Bounds::is_overlap(gap, shapes_.tolerance()); });
    }
    // Writes what contacts change in the step into `forces`. Returns Touch::nothing or Touch::rests. `only_at_rest`:
    // nothing is computed unless the island is at rest.
    Touch solve(const Kicks& loads, Kicks& forces, Solution& solution, Changes& changes, bool only_at_rest) {
        solution = {};
        if constexpr (features.moving_surfaces()) velocities_.surfaces.carry = false;
        bool any = false;
        pairs_.for_each(island_, [&](const Pair& pair) { any = any || pair.count > 0; });
        if (!any) return Touch::nothing;
        // In parts of a step nothing is corrected.
        const bool whole = halvings_ == 0, lifts = whole && overlap();
        if (only_at_rest && lifts) return Touch::nothing;
        Work part(1);
        for (int i = 0; i < halvings_; ++i) part = N::half_of(part);
        // Bodies go through the step as fast as at its end, so on a surface that turns they follow its middle.
        if constexpr (features.moving_surfaces()) rows_.look_ahead(N::half_of(part), true);
        const bool same = rows_.template set_velocities<&Bounds::correction>(loads, part, whole, lifts);
        is_slow_ = !set_targets(same);
        const bool found =
            whole && is_slow_ &&
            Statics<N, spin, features>{shapes_, pairs_, velocities_, bodies_, island_, true}.solve(only_at_rest);
        if (found) {
            velocities_.write(forces, bodies_, shapes_.weights(), island_.group, &loads);
            solution.at_rest = !lifts && pairs_.are_balanced(island_) && velocities_.start_at_rest(island_.group);
        } else if (only_at_rest) {
            return Touch::nothing;
        } else {
            make_faces();
            rows_.push_all();
            sweep();
            if (bounces_) bound_bounces();
            if (!bounces_) take_off_work();
            velocities_.write(forces, bodies_, shapes_.weights(), island_.group);
        }
        pairs_.count_points(island_, shapes_.tolerance());
        note(changes);
        changes.glides = found && !closes_ && !changes.any_exceeds(island_.group);
        if (lifts) [[unlikely]]
            find_lifts(solution);
        solution.unchanged = !solution.lifts;
        return Touch::rests;
    }

    // Adds the impulses of the last solution to the log, with the speeds of approach that are no rest.
    void log([[maybe_unused]] auto& log) {
        if constexpr (features.contact_readout)
            pairs_.for_each(island_, [&](const Pair& pair) {
                auto* const entry = log.add(pair, shapes_, bodies_, Work(1));
                if (entry == nullptr) return;
                const Speed slow = rows_.pair_speed(pair, shapes_.slow());
                for (int i = 0; i < pair.count; ++i) {
                    const Point& point = pair.point[i];
                    if (!(point.row[0].impulse > Speed{})) continue;
                    const Speed approach = -rows_.velocity(velocities_.start, pair, point);
                    if (!(approach > Rows::along(point, slow))) continue;
                    const Work speed = rows_.metres_per_step(pair, point, approach);
                    if (speed > entry->hit_speed) entry->hit_speed = speed;
                }
            });
    }

private:
    using Square = decltype(dot(Vec3<Speed>{}, Vec3<Speed>{}));

    // Makes the rows and sets what they want: a point that comes down bounces at once, another one may come as far as
    // its surface. True where a point comes faster than what settles, or bounces.
    bool set_targets(bool same) {
        bool fast = false;
        bounces_ = closes_ = false;
        points_ = 0;
        pairs_.for_each(island_, [&](Pair& pair) {
            if (!same || !(pair.scale == velocities_.scale)) pairs_.unbalance(pair);
            pair.touched = pair.count > 0;
            if (pair.count == 0) return;
            closes_ = closes_ || pair.surface_moves;
            rows_.make_rows(pair);
            points_ += pair.count;
            const Speed slow = rows_.pair_speed(pair, shapes_.slow()), least = rows_.pair_speed(pair, threshold_);
            for (int i = 0; i < pair.count; ++i) {
                Point& point = pair.point[i];
                point.active = true;
                const Speed approach = -rows_.velocity(velocities_.start, pair, point);
                fast = fast || approach > Rows::along(point, slow + slow);
                closes_ = closes_ || magnitude_of(approach) > Rows::along(point, Bounds::slow(Bounds::fall(slow)));
                point.row[0].target = least_speed(pair, point);
                if (approach > Rows::along(point, larger_of(slow, least)) && pair.restitution > Unit{})
                    bounce(pair, point, approach);
                point.for_each_row([&](auto& row) { row.impulse = velocities_.scale.from(row.impulse, pair.scale); });
            }
            pair.scale = velocities_.scale;
        });
        return fast || bounces_;
    }
    [[nodiscard]] Faces<N, spin, features> faces() const { return {shapes_, pairs_, island_, rows_}; }
    void make_faces() {
        if constexpr (Pair::has_faces) {
            faces_ = faces().make();
            rows_.solve_faces(faces_);
        }
    }
    // The speed that closes the gap of a point within the part of the step.
    [[nodiscard]] Speed to_surface(const Pair& pair, const Point& point) const {
        Length way = point.gap;
        for (int i = 0; i < halvings_; ++i) way = way < C::half(C::longest()) ? Length(way + way) : C::longest();
        return way > Length{} ? rows_.speed(pair, point, way) : Speed{};
    }
    // That of a point which ends the step at the surface; below it, that of the surface.
    [[nodiscard]] Speed least_speed(const Pair& pair, const Point& point) const {
        return Rows::surface_of(pair, point) - to_surface(pair, point);
    }
    // A point that would come to the surface within the step leaves it by what restitution gives back of its approach,
    // and by what loads change.
    void bounce(const Pair& pair, Point& point, Speed approach) {
        const Speed loaded = -rows_.velocity(velocities_.loaded, pair, point);
        if (!(loaded > to_surface(pair, point))) return;
        bounces_ = true;
        point.row[0].target =
            Rows::surface_of(pair, point) + narrow<Speed>(mul(approach, pair.restitution)) + approach - loaded;
    }
    // Where something is fast, fewer sweeps of more points, so that the time of a step grows with the pairs; as many in
    // every number system. Where nothing is, those of the forces of a step: with fewer a heap creeps on for ever, since
    // what each step leaves of a load moves the points that the next one begins from. Sweeps may be far from done where
    // a light body is under heavy ones. Surfaces have the last word: nothing goes through them.
    void sweep() {
        const int most = faces_     ? contact::face_sweeps
                         : is_slow_ ? contact::max_sweeps
                                    : detail::clamp(contact::bounded_visits / points_, contact::least_bounded_sweeps,
                                                    contact::max_sweeps);
        (void)rows_.sweep({velocities_.scale.enough_at_rest(), most, most});
        rows_.sweep_surfaces(false);
    }
    // Of the change P by contacts, less the work of surfaces that move: u0 . P, L . P, and P . P; and |u - u0|^2. u0, L
    // and u are the velocities at the start, with loads, and at the end.
    struct WorkOfContacts {
        Square from_start{}, from_loaded{}, square{}, change{};
    };
    [[nodiscard]] WorkOfContacts work_of_contacts() {
        WorkOfContacts work;
        for_each_part([&](int b, auto part) {
            const Vec3<Speed>&start = velocities_.start[b].*part, &loaded = velocities_.loaded[b].*part,
                  &end = velocities_.now[b].*part, by = end - loaded, change = end - start;
            work.from_start += dot(start, by);
            work.from_loaded += dot(loaded, by);
            work.square += dot(by, by);
            work.change += dot(change, change);
        });
        if constexpr (features.moving_surfaces()) {
            Square given{};
            pairs_.for_each_active(island_, [&](const Pair& pair, Point& point) {
                if (!pair.surface_moves) return;
                given += mul(point.row[0].impulse, Rows::surface_of(pair, point));
                for (int k = 1; k < pair.rows(); ++k) given += mul(point.row[k].impulse, point.row[k].target);
                if constexpr (features.rolling_resistance)
                    for (const auto& row : point.spin) given += mul(row.impulse, row.target);
            });
            work.from_start -= given;
            work.from_loaded -= given;
        }
        return work;
    }
    // What bounces gives back a part of the energy of its approach, but several bounces at one moment may together give
    // back more than there was. With s P, s = -2 u0 . P / P . P, the energy is that of the start. This is taken where s
    // is 63/64 at least: what rests then misses at most 1/64 of its support in this step. Else all bounces of the
    // island are left out.
    void bound_bounces() {
        const WorkOfContacts work = work_of_contacts();
        const Square by_end = work.from_loaded + work.square, back = -(work.from_start + work.from_start),
                     beyond = work.square - back;
        if (!(by_end + by_end > work.change) || !(beyond > Square{})) return;
        Square most = work.square;
        for (int i = 0; i < 6; ++i) most = C::half(most);
        if (beyond < most) take_part(C::ratio_of_squares(back, work.square));
        else drop_bounces();
    }
    [[gnu::noinline, gnu::cold]] void drop_bounces() {
        bounces_ = false;
        pairs_.for_each_active(island_,
                               [&](const Pair& pair, Point& point) { point.row[0].target = least_speed(pair, point); });
        if (faces_) faces().set_targets();
        sweep();
    }
    // Without bounces contacts do no work by the velocities of the end, but for that of surfaces that move, and for
    // sweeps that are not done: of P the largest part s, at most 1, is taken for which that is so.
    void take_off_work() {
        const WorkOfContacts of = work_of_contacts();
        const Square work = -of.from_loaded, square = of.square;
        if (square > work) take_part(work > Square{} ? C::ratio_of_squares(work, square) : Unit{});
    }
    void take_part(Unit share) {
        using Row = tumble::Row<N, features.pairs>;
        for_each_part([&](int b, auto part) {
            const Vec3<Speed>& loaded = velocities_.loaded[b].*part;
            Vec3<Speed>& now = velocities_.now[b].*part;
            now = loaded + Row::products(now - loaded, share);
        });
        pairs_.for_each_active(island_, [&](Pair&, Point& point) {
            point.for_each_row([&](auto& row) { row.impulse = Row::product(row.impulse, share); });
        });
    }
    // Call before find_lifts(), which needs the room of the velocities with loads. Bounds of a body near something
    // allow for twice what gravity changes.
    void note(Changes& changes) const {
        changes.trembles = true;
        for (int k = 0; k < island_.group.count; ++k) {
            const int b = island_.group.id[k];
            const Velocity& start = velocities_.start[b];
            const auto change_to = [&](const Velocity& to) {
                return Velocity{to.linear - start.linear, to.angular - start.angular};
            };
            const Velocity change = change_to(velocities_.now[b]), by_loads = change_to(velocities_.loaded[b]);
            const Speed least = sum_of_magnitudes(by_loads.linear);
            changes.exceed[b] = sum_of_magnitudes(change.linear) > least + least;
            changes.trembles = changes.trembles && change.largest() < C::half(by_loads.largest());
        }
    }
    // The motion that corrects overlaps, by few sweeps over the normals, from none in each step.
    [[gnu::noinline, gnu::cold]] void find_lifts(Solution& solution) {
        pairs_.for_each_active(island_, [&](Pair& pair, Point& point) {
            const Length lift = Bounds::correction(point.gap, shapes_.tolerance());
            solution.lifts = solution.lifts || lift > Length{};
            point.resting_impulse = point.row[0].impulse;
            point.row[0].impulse = Speed{};
            point.row[0].target = least_speed(pair, point) + rows_.speed(pair, point, lift);
        });
        if (faces_) faces().set_targets();
        else if (solution.lifts) make_faces();
        auto& lifts = velocities_.added();
        for_each_part([&](int b, auto part) { lifts[b].*part = velocities_.now[b].*part; });
        if (solution.lifts) {
            (void)rows_.sweep_normals({velocities_.scale.enough_at_rest(), contact::bounded_corrections}, false);
            rows_.sweep_surfaces(true);
        }
        for_each_part([&](int b, auto part) { lifts[b].*part = velocities_.now[b].*part - lifts[b].*part; });
        pairs_.for_each_active(island_, [](Pair&, Point& point) { point.row[0].impulse = point.resting_impulse; });
    }
    template <class F>
    void for_each_part(F&& f) const {
        for (int k = 0; k < island_.group.count; ++k)
            for (Vec3<Speed> Velocity::*part : Velocity::parts) f(island_.group.id[k], part);
    }

    const NarrowPhase& shapes_;
    PairList& pairs_;
    Velocities& velocities_;
    typename NarrowPhase::Bodies& bodies_;
    const Island& island_;
    Rows rows_;
    Work threshold_;
    int halvings_;
    int points_ = 0;
    bool bounces_ = false;
    bool is_slow_ = false;  // no point comes faster than what settles, and none bounces
    bool faces_ = false;    // nothing touches but faces
    bool closes_ = false;   // a point comes to its surface or leaves it, or the surface moves
};

}  // namespace tumble

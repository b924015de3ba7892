// The materials of bodies and planes, and how the two sides of a contact make one.
#pragma once

#include <tumble/body/setup.hpp>
#include <tumble/numbers/systems.hpp>
#include <tumble/scene.hpp>

namespace tumble {

// Of a side. Negative: the world's values.
template <class N, Features features>
struct Material {
    using Work = typename N::Work;
    Work restitution{}, friction{};
    // m: moments over the normal force.
    [[no_unique_address]] If<features.rolling_resistance, Work, 0> rolling{};
    [[no_unique_address]] If<features.rolling_resistance, Work, 1> spinning{};

    Material() = default;
    constexpr explicit Material(const auto& spec)
        : restitution{N::template constant<Work>(spec.restitution)}, friction{
                                                                         N::template constant<Work>(spec.friction)} {
        if constexpr (features.rolling_resistance) {
            rolling = N::template constant<Work>(spec.rolling_resistance);
            spinning = N::template constant<Work>(spec.spinning_resistance);
        }
    }
};

template <class N, Features features>
class Materials {
public:
    using Work = typename N::Work;
    using Material = tumble::Material<N, features>;

    Material body[features.bodies > 0 ? features.bodies : 1]{}, plane[features.planes > 0 ? features.planes : 1]{};

    constexpr explicit Materials(const ContactSpec& spec) : world_{spec} {
        if constexpr (features.mixing) mixing_ = {spec.restitution_mixing, spec.friction_mixing};
    }

    // Of two sides. The larger restitution, if the scene asks for no other; a side without one has that of the other.
    [[nodiscard]] Work restitution(const Material& a, const Material& b) const {
        const Work first = a.restitution, second = b.restitution, none(0);
        if constexpr (features.mixing)
            if (mixing_.restitution != Mixing::larger) return mixed(mixing_.restitution, a, b, &Material::restitution);
        if (first < none && second < none) return world_.restitution;
        return first < second ? second : first;
    }
    // The geometric mean, if the scene asks for no other.
    [[nodiscard]] Work friction(const Material& a, const Material& b) const {
        if constexpr (features.mixing)
            if (mixing_.friction != Mixing::geometric_mean) return mixed(mixing_.friction, a, b, &Material::friction);
        const Work x = value(a, &Material::friction), y = value(b, &Material::friction);
        return x == y ? x : sqrt(x * y);
    }
    // The larger resistance, to rolling or to spinning.
    [[nodiscard]] Work resistance(const Material& a, const Material& b, Work Material::*to) const {
        return mixed(Mixing::larger, a, b, to);
    }

private:
    [[nodiscard]] Work value(const Material& side, Work Material::*of) const {
        return side.*of < Work(0) ? world_.*of : side.*of;
    }
    [[nodiscard]] Work mixed(Mixing mixing, const Material& a, const Material& b, Work Material::*of) const {
        const Work x = value(a, of), y = value(b, of);
        switch (mixing) {
        case Mixing::larger: return x < y ? y : x;
        case Mixing::smaller: return x < y ? x : y;
        case Mixing::mean: return N::half_of(x + y);
        case Mixing::geometric_mean: return sqrt(x * y);
        case Mixing::product: break;
        }
        return x * y;
    }

    struct Mixings {
        Mixing restitution, friction;
    };
    Material world_;
    [[no_unique_address]] If<features.mixing, Mixings, 0> mixing_{};
};

}  // namespace tumble

// A mechanism in a world of this kernel, by the default method.
#pragma once

#include <tumble/tumble.hpp>

#include "mechanism.hpp"
#include "simulation/motion_of.hpp"

namespace tumble::bench {

template <class N, int links>
class MechanismWorld {
public:
    MechanismWorld(const Mechanism& mechanism, int rate)
        : world_{Seconds{1, rate}, {.gravity = {0, Real{-gravity}, 0}}} {
        const auto vector = [](reference::Vector v) {
            return RealVec3{Real{static_cast<double>(v.x)}, Real{static_cast<double>(v.y)},
                            Real{static_cast<double>(v.z)}};
        };
        for (int i = 0; i < links; ++i) {
            const Link& link = mechanism.links[static_cast<std::size_t>(i)];
            const RealVec3 moments = vector(link.moments), anchor = vector(link.anchor);
            BodySpec body;
            body.mass = Real{link.mass};
            body.inertia = {moments.x, moments.y, moments.z, {}, {}, {}};
            body.position = vector(link.start.x);
            body.orientation = {Real{static_cast<double>(link.start.q.w)}, vector(link.start.q.v)};
            body.velocity = vector(link.start.v);
            body.angular_velocity = vector(link.start.w);
            axes_.emplace_back(principal_inertia(body.inertia));
            (void)world_.add(body);
            if (link.is_hinge())
                (void)world_.add(HingeSpec{.body = i, .to_body = i - 1, .anchor = anchor, .axis = vector(link.axis)});
            else (void)world_.add(BallSpec{.body = i, .to_body = i - 1, .anchor = anchor});
        }
    }

    // The whole step is one function, as in the firmware that the cores run.
    [[gnu::flatten]] void step() { (void)world_.step(); }
    [[nodiscard]] std::vector<reference::Motion> motions() const {
        std::vector<reference::Motion> motions;
        for (int i = 0; i < links; ++i)
            motions.push_back(host::motion_of(world_.bodies(), axes_[static_cast<std::size_t>(i)], i));
        return motions;
    }
    [[nodiscard]] std::string trouble() const {
        std::string names;
        for (const Issue issue : all_issues)
            if (world_.status().has(issue)) names += (names.empty() ? "" : " ") + std::string{name_of(issue)};
        return names;
    }

private:
    World<SceneOf<N, integrators::Verlet, Features{.bodies = links, .joints = links}>> world_;
    std::vector<host::PrincipalAxes> axes_;
};

}  // namespace tumble::bench

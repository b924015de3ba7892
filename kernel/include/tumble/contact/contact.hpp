// What a program reads of a contact of a body: World::contacts().
#pragma once

#include <tumble/body/id.hpp>
#include <tumble/numbers/vector.hpp>
#include <tumble/shapes/manifold.hpp>

namespace tumble {

// Two bodies, or a body and a plane, that touch at the end of the last step, or did in it or before it. `Work` is the
// number of the world's accessors. The impulses are those of the whole last step: of forces and of impacts. Of a body
// that stands or sleeps they are those of every step.
template <class Work>
struct Contact {
    BodyId body;             // the partner; the id of nothing where that is a plane
    PlaneId plane;           // the partner; the id of nothing where that is a body
    bool touches = false;    // at the end of the last step
    bool began = false;      // it touches, and did not at the end of the step before
    bool ended = false;      // it does not touch, and did at the end of the step before
    bool hit = false;        // an impact ended an approach, of more than 2^-16 of the tolerance in a step
    Work hit_speed{};        // m/s, of the fastest such approach
    Vector3<Work> normal{};  // unit vector from the partner to the body, world
    Work depth{};  // m, of the deepest point; negative: the gap. As it was when they were last near each other
    // m, world: the centre of pressure, at which the normal impulse acted, as the bodies were when it was solved for.
    // Without such an impulse the mean of `points`, and zero without points.
    Vector3<Work> point{};
    Vector3<Work> impulse{};                      // N s, on the body, world: the part along the normal and friction
    Work normal_impulse{};                        // N s, along the normal, not negative
    Vector3<Work> friction_impulse{};             // N s, across the normal, on the body, world
    int point_count = 0;                          // contact points at the end of the last step
    Vector3<Work> points[contact::max_points]{};  // m, world, halfway between the two surfaces
};

// The contacts of a body, each read from the world when a loop comes to it.
template <class World>
class ContactRange {
public:
    // What a loop holds.
    class Iterator {
    public:
        // From entry `at` of the log on.
        Iterator(const World& world, int body, int at) : world_{&world}, body_{body}, at_{at} { skip(); }
        [[nodiscard]] auto operator*() const { return world_->logged(at_, body_); }
        Iterator& operator++() {
            ++at_;
            skip();
            return *this;
        }
        friend bool operator==(const Iterator& a, const Iterator& b) { return a.at_ == b.at_; }

    private:
        void skip() {
            while (at_ < world_->logged_count() && !world_->is_logged(at_, body_)) ++at_;
        }

        const World* world_;
        int body_, at_;
    };

    // Of the body at this place.
    ContactRange(const World& world, int body) : world_{world}, body_{body} {}
    // The first contact.
    [[nodiscard]] Iterator begin() const { return {world_, body_, 0}; }
    // Behind the last one.
    [[nodiscard]] Iterator end() const { return {world_, body_, world_.logged_count()}; }

private:
    const World& world_;
    int body_;
};

}  // namespace tumble

// Box2D on planar scenes, with the 8 velocity and 3 position iterations that its manual suggests: spheres as circles
// and boxes as polygons, with the mass and the moment of the scene. Its polygons and edges have a skin of
// b2_polygonRadius; they are made smaller by it, so that their outer surface is that of the scene. Slower impacts than
// its default of 1 m/s would not bounce; the scene's threshold is set instead.
#include "contender.hpp"

#include <box2d/box2d.h>

#include <cmath>

namespace {

using namespace tumble;
using namespace tumble::bench;

// A scene's plane is x and y, or, without gravity, x and z.
struct Plane {
    bool flat;  // x and z

    [[nodiscard]] b2Vec2 to_plane(const RealVec3& v) const {
        const auto a = array_of<float>(v);
        return {a[0], flat ? a[2] : a[1]};
    }
    [[nodiscard]] reference::Vector to_space(const b2Vec2& v) const {
        if (flat) return {v.x, 0, v.y};
        return {v.x, v.y, 0};
    }
};

[[nodiscard]] bool all_are_zero(const SceneData& scene, Real RealVec3::*axis) {
    const RealVec3& g = scene.world.gravity;
    bool zero = (g.*axis).is_zero();
    for (const BodySpec& body : scene.bodies)
        zero &= (body.position.*axis).is_zero() && (body.velocity.*axis).is_zero();
    return zero;
}
[[nodiscard]] bool is_planar(const SceneData& scene) {
    for (const BodySpec& body : scene.bodies) {
        const auto w = array_of<double>(body.angular_velocity), u = array_of<double>(body.orientation.v);
        const ShapeKind kind = body.shape.kind;
        if (body.is_fixed() || (kind != ShapeKind::box && kind != ShapeKind::sphere) || w[0] != 0 || w[1] != 0 ||
            w[2] != 0 || u[0] != 0 || u[1] != 0)
            return false;
    }
    return all_are_zero(scene, &RealVec3::z) || (scene.planes.empty() && all_are_zero(scene, &RealVec3::y));
}

class World {
public:
    explicit World(const Problem& problem)
        : problem_{problem}, plane_{!all_are_zero(problem.scene, &RealVec3::z)}, world_{plane_.to_plane(
                                                                                     problem.scene.world.gravity)} {
        world_.SetAllowSleeping(false);
        for (const BodySpec& spec : problem.scene.bodies) add(spec);
        for (const PlaneSpec& spec : problem.scene.planes) add(spec);
    }

    void step() { world_.Step(static_cast<float>(problem_.step()), 8, 3); }
    [[nodiscard]] Motions motions() const {
        Motions motions;
        for (const b2Body* body : bodies_) {
            const double half = body->GetAngle() / 2.0;
            motions.push_back({plane_.to_space(body->GetPosition()),
                               plane_.to_space(body->GetLinearVelocity()),
                               {std::cos(half), {0, 0, std::sin(half)}},
                               {0, 0, body->GetAngularVelocity()}});
        }
        return motions;
    }
    [[nodiscard]] static bool asleep(int /*body*/) { return false; }

private:
    void add(const BodySpec& spec) {
        b2BodyDef def;
        def.type = b2_dynamicBody;
        def.position = plane_.to_plane(spec.position);
        def.linearVelocity = plane_.to_plane(spec.velocity);
        def.angle =
            static_cast<float>(2 * std::atan2(spec.orientation.v.z.to_double(), spec.orientation.w.to_double()));
        b2Body* body = world_.CreateBody(&def);
        bodies_.push_back(body);
        const auto size = array_of<float>(spec.shape.size);
        b2CircleShape circle;
        b2PolygonShape box;
        if (spec.shape.kind == ShapeKind::sphere) {
            circle.m_radius = size[0];
            touch(*body, circle);
        } else {
            box.SetAsBox(size[0] / 2 - b2_polygonRadius, size[1] / 2 - b2_polygonRadius);
            touch(*body, box);
        }
        const b2MassData mass{
            static_cast<float>(spec.mass.to_double()), {0, 0}, static_cast<float>(principal_moments(spec)[2])};
        body->SetMassData(&mass);
    }
    void add(const PlaneSpec& spec) {
        constexpr float half = 100;  // m, of the edge's length
        const auto n = plane_.to_plane(normalized(spec.normal));
        const b2Vec2 tangent{n.y, -n.x};
        b2BodyDef def;
        def.position = -(static_cast<float>(spec.offset.to_double()) + b2_polygonRadius) * n;
        b2EdgeShape edge;
        edge.SetTwoSided(-half * tangent, half * tangent);
        touch(*world_.CreateBody(&def), edge);
    }
    void touch(b2Body& body, const b2Shape& shape) const {
        const ContactSpec& contact = problem_.scene.world.contact;
        b2FixtureDef def;
        def.shape = &shape;
        def.density = 1;
        def.friction = static_cast<float>(contact.friction.to_double());
        def.restitution = static_cast<float>(contact.restitution.to_double());
        def.restitutionThreshold = static_cast<float>(contact.restitution_threshold.to_double());
        body.CreateFixture(&def);
    }

    const Problem& problem_;
    Plane plane_;
    b2World world_;
    std::vector<b2Body*> bodies_;  // of the world
};

}  // namespace

void tumble::bench::add_box2d(Contenders& contenders) {
    contenders.push_back({"Box2D", TUMBLE_BOX2D_VERSION, "8 velocity, 3 position iterations", "f32", false,
                          [](const Problem& problem) -> std::unique_ptr<Runner> {
                              if (!is_planar(problem.scene)) return nullptr;
                              return std::make_unique<RemakingRunner<World>>(problem);
                          }});
}

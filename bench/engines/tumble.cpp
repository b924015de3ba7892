// This kernel on the same top: every integrator of its list, in integers and in plain float and double.
#include "contender.hpp"

#include <tumble/integrators/list.hpp>
#include <tumble/tumble.hpp>

namespace {

using namespace tumble::bench;

template <class N, class Method>
class TumbleTop final : public Runner {
public:
    TumbleTop() {
        tumble::BodySpec body;
        body.mass = tumble::Real{1};
        body.inertia = {
            tumble::Real{top_moments[0]}, tumble::Real{top_moments[1]}, tumble::Real{top_moments[2]}, {}, {}, {}};
        body.angular_velocity = {tumble::Real{top_spin[0]}, tumble::Real{top_spin[1]}, tumble::Real{top_spin[2]}};
        top_ = world_.add(body);
    }

    // The whole step is one function, as in the firmware that the cores run.
    [[gnu::flatten]] void step() override { (void)world_.step(); }
    [[nodiscard]] std::array<double, 4> orientation() const override {
        const auto& q = world_.state(top_).q_wb;
        const auto p = world_.bodies().constants[top_.index()].principal();
        const std::array<double, 4> a{number(q.w), number(q.x), number(q.y), number(q.z)},
            b{number(p.w), -number(p.v.x()), -number(p.v.y()), -number(p.v.z())};
        return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
                a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
                a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
                a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
    }
    [[nodiscard]] std::array<double, 3> spin() const override {
        const auto w = world_.angular_velocity(top_);
        return {number(w.x), number(w.y), number(w.z)};
    }

private:
    template <class T>
    [[nodiscard]] static double number(const T& value) {
        if constexpr (std::floating_point<T>) return static_cast<double>(value);
        else if constexpr (requires { value.to_real(); }) return value.to_real().to_double();
        else return static_cast<double>(value);
    }

    tumble::World<tumble::SceneOf<N, Method, tumble::Features{}>> world_{tumble::Seconds{1, top_steps_per_second}};
    tumble::BodyId top_;
};

}  // namespace

int main(int argc, char** argv) {
    std::vector<Contender> contenders;
    const auto add = [&]<class N>() {
        tumble::Integrators::for_each_in<N>([&]<class Method>() {
            contenders.push_back({"tumble", "", Method::name, N::name, N::carry,
                                  [] { return std::make_unique<TumbleTop<N, Method>>(); }});
        });
    };
    add.template operator()<tumble::Q32<tumble::NearRange>>();
    add.template operator()<tumble::F32Plain>();
    add.template operator()<tumble::F64>();
    return contest(argc, argv, contenders);
}

// Replay<Config, Data>: a world set up from a scene's data, and stepped. A firmware (constant data) and the host (data
// read at run time) both set up here, so both do the same arithmetic in the same order.
//
// Data has the members name, step (Seconds), steps, world (WorldSpec) and the lists bodies, planes, springs, impulses
// and forces of their *Spec, all static constexpr in what `tumble compile` writes. A list is a std::array or anything
// with size() that resize() can grow. Config is a Scene with room for all of it and the features it needs.
#pragma once

#include <tumble/world.hpp>

#include <cstddef>

namespace tumble {

// Calls f(name, number) for each carried number of a body's state, in the order in which Hash digests them.
template <class N, Spin spin, class F>
constexpr void for_each_number(const BodyState<N, spin>& body, F&& f) {
    f("x_w.x", body.x_w.x);
    f("x_w.y", body.x_w.y);
    f("x_w.z", body.x_w.z);
    f("d_w.x", body.d_w.x);
    f("d_w.y", body.d_w.y);
    f("d_w.z", body.d_w.z);
    f("q_wb.w", body.q_wb.w);
    f("q_wb.x", body.q_wb.x);
    f("q_wb.y", body.q_wb.y);
    f("q_wb.z", body.q_wb.z);
    f("t_b.x", body.t_b.x);
    f("t_b.y", body.t_b.y);
    f("t_b.z", body.t_b.z);
}

namespace detail {

template <class F>
constexpr void for_each_word_of(float value, F&& f) {
    f(std::bit_cast<std::uint32_t>(value));
}
template <class F>
constexpr void for_each_word_of(std::uint64_t value, F&& f) {
    f(static_cast<std::uint32_t>(value));
    f(static_cast<std::uint32_t>(value >> 32));
}
template <class F>
constexpr void for_each_word_of(double value, F&& f) {
    for_each_word_of(std::bit_cast<std::uint64_t>(value), f);
}

template <class N>
[[nodiscard]] constexpr std::uint32_t start_of(const Impulse<N>& impulse) {
    return impulse.step;
}
template <class N>
[[nodiscard]] constexpr std::uint32_t start_of(const Thrust<N>& thrust) {
    return thrust.from;
}

// The world's own numbers, sorted by their first step; what starts together keeps its order.
template <class Events, class Specs, class Bodies>
[[nodiscard]] auto prepare(Events& events, const Specs& specs, const Bodies& bodies) {
    if constexpr (requires { events.resize(specs.size()); }) events.resize(specs.size());
    std::size_t count = 0;
    for (const auto& spec : specs) {
        const auto event = bodies.prepare(spec);
        std::size_t place = count++;
        for (; place > 0 && start_of(event) < start_of(events[place - 1]); --place) events[place] = events[place - 1];
        events[place] = event;
    }
    return Span<std::remove_cvref_t<decltype(events[0])>>{events.data(), static_cast<int>(count)};
}

// A list like List, of T: as many of them, or as growable.
template <class List, class T>
struct ListOf;
template <template <class, std::size_t> class Array, class Spec, std::size_t size, class T>
struct ListOf<Array<Spec, size>, T> {
    using type = Array<T, size>;
};
template <template <class...> class List, class Spec, class... Rest, class T>
struct ListOf<List<Spec, Rest...>, T> {
    using type = List<T>;
};

}  // namespace detail

// Calls f(word) for the 32-bit words of one carried number; the lower half of a longer one first.
template <class T, bool carry, bool biased, class F>
constexpr void for_each_word(const Carried<T, carry, biased>& number, F&& f) {
    if constexpr (std::floating_point<T>) {
        detail::for_each_word_of(number.value(), f);
        if constexpr (carry) detail::for_each_word_of(number.residual(), f);
    } else if constexpr (carry) {
        detail::for_each_word_of(static_cast<std::uint64_t>(number.sum().raw), f);
    } else {
        f(static_cast<std::uint32_t>(number.value().raw));
    }
}
template <class T, bool carry, class F>
constexpr void for_each_word(const Shaped<T, carry>& number, F&& f) {
    if constexpr (requires { number.left_out(); }) {
        detail::for_each_word_of(static_cast<std::uint64_t>(number.sum().raw), f);
        f(number.left_out());
    } else {
        for_each_word(static_cast<const Carried<T, carry>&>(number), f);
    }
}

template <class Config, class Data>
class Replay {
    using N = typename Config::Numbers;
    template <class List, class T>
    using Prepared = typename detail::ListOf<std::remove_cvref_t<List>, T>::type;

public:
    // Sets up the scene's bodies and what acts on them. A scene without room for them sets Issue::world_full or drops
    // what is too much: check Config against the data first.
    explicit Replay(const Data& data = Data{}) : world_{data.step, data.world} {
        for (const BodySpec& body : data.bodies) (void)world_.add(body);
        if constexpr (Config::planes > 0)
            for (const PlaneSpec& plane : data.planes) (void)world_.add(plane);
        if constexpr (Config::springs > 0)
            for (const SpringSpec& spring : data.springs) (void)world_.add(spring);
        if constexpr (Config::script) world_.set_script(detail::prepare(impulses_, data.impulses, world_.bodies()));
        if constexpr (Config::forces) world_.set_forces(detail::prepare(forces_, data.forces, world_.bodies()));
    }
    // The world points into the prepared arrays.
    Replay(const Replay&) = delete;
    Replay& operator=(const Replay&) = delete;

    Status step() { return world_.step(); }
    [[nodiscard]] World<Config>& world() { return world_; }
    [[nodiscard]] const World<Config>& world() const { return world_; }

private:
    World<Config> world_;
    [[no_unique_address]] Prepared<decltype(Data::impulses), Impulse<N>> impulses_{};
    [[no_unique_address]] Prepared<decltype(Data::forces), Thrust<N>> forces_{};
};

}  // namespace tumble

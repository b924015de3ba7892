// Events of many steps: a script, which a world applies, and a recording, which a world writes. A recording is a
// script: a world that starts where the recording started, and applies it, reaches the same state in every bit.
#pragma once

#include <tumble/events/event.hpp>

namespace tumble {

// An event of a scene, in SI units. World::prepare() makes an Event from it.
struct EventSpec {
    Real time = 0;                        // s, rounded to the nearest step; the event comes before that step
    EventKind kind = EventKind::impulse;  // what happens
    BodyIndex body = 0;  // its id, or its number in the order of add(); not used by gravity; of a joint its place
    Frame frame = Frame::world;  // of `value`
    RealVec3 value{};            // see EventKind
    RealVec3 point{};            // m, user's body axes, from the centre of mass
    RealQuat orientation{};      // user's body axes to world

    static constexpr void each(auto&& f, auto&... of) {  // see Field
        f(Field{"time", "s", Field::not_negative}, of.time...);
        f(Field{"kind"}, of.kind...);
        f(Field{"body", "", Field::body}, of.body...);
        f(Field{"frame"}, of.frame...);
        f(Field{"value"}, of.value...);
        f(Field{"point", "m"}, of.point...);
        f(Field{"orientation"}, of.orientation...);
    }
};

// A constant array that outlives the world: flash in a firmware.
template <class T>
struct Span {
    const T* first = nullptr;  // the first element
    int count = 0;             // number of elements

    // For loops over the elements.
    [[nodiscard]] constexpr const T* begin() const { return first; }
    // Past the last element.
    [[nodiscard]] constexpr const T* end() const { return first + count; }
};

namespace detail {

// An event of a scene in the numbers of a world with steps of this length, s. The body is not checked.
template <class N>
[[nodiscard]] constexpr Event<N> event_of(const EventSpec& spec, Real step_length) {
    return {spec.kind,
            spec.frame,
            spec.kind != EventKind::gravity ? BodyId{spec.body} : BodyId{},
            spec.value,
            spec.point,
            spec.orientation.template as<typename N::Work>(),
            nearest_step(spec.time, step_length)};
}

}  // namespace detail

// An event of a scene in the numbers of the bodies' world.
template <class N, Spin spin, int capacity, bool points, class Constant>
[[gnu::noinline, nodiscard]] constexpr Event<N> prepare(const Bodies<N, spin, capacity, points, Constant>& bodies,
                                                        const EventSpec& spec) {
    if (has_body(spec.kind)) (void)bodies.index_of(spec.body);
    return detail::event_of<N>(spec, bodies.step_length);
}

namespace detail {

// Writes event_of(spec) of each, sorted by step. Events with equal steps keep their order.
template <class Events, class Specs, class F>
constexpr void prepare_each(Events& events, const Specs& specs, F&& event_of) {
    for (std::size_t i = 0; i < specs.size(); ++i) {
        const auto event = event_of(specs[i]);
        std::size_t place = i;
        for (; place > 0 && event.step < events[place - 1].step; --place) events[place] = events[place - 1];
        events[place] = event;
    }
}

}  // namespace detail

// Events in the numbers of the world, sorted by step. Events with equal steps keep their order.
template <class Events, class Specs, class Bodies>
[[nodiscard]] constexpr auto prepare_sorted(Events& events, const Specs& specs, const Bodies& bodies) {
    if constexpr (requires { events.resize(specs.size()); }) events.resize(specs.size());
    detail::prepare_each(events, specs, [&](const auto& spec) { return prepare(bodies, spec); });
    return Span<std::remove_cvref_t<decltype(events[0])>>{events.data(), static_cast<int>(specs.size())};
}

// An array that is sorted by step, and the place of the next element. Timed is an Event, or any record of a program
// with a member `step`, from 0: a program walks a recording in its own numbers with for_each_due() before each step of
// the world. It makes each event when it is due, by a call of the world, so that only the records take memory.
template <class Timed>
class Script {
public:
    // The array must outlive its use. Events before step `now` are skipped.
    constexpr void set(Span<Timed> events, std::uint64_t now) {
        for (int i = 1; i < events.count; ++i) TUMBLE_ASSERT(events.first[i - 1].step <= events.first[i].step);
        events_ = events;
        seek(now);
    }
    // Skips what comes before step `now`, after the world has gone to this step.
    constexpr void seek(std::uint64_t now) {
        next_ = 0;
        while (next_ < events_.count && static_cast<std::uint64_t>(events_.first[next_].step) < now) ++next_;
    }
    // True if an event has been skipped or applied.
    [[nodiscard]] constexpr bool has_passed() const { return next_ > 0; }
    // Calls f(event) for each event that has been skipped or applied, in the order of the array.
    template <class F>
    void for_each_passed(F&& f) const {
        for (int i = 0; i < next_; ++i) f(events_.first[i]);
    }
    // Calls apply(event) for each event that is due at step `now`, in the order of the array.
    template <class F>
    TUMBLE_INLINE void for_each_due(std::uint64_t now, F&& apply) {
        while (next_ < events_.count && static_cast<std::uint64_t>(events_.first[next_].step) <= now)
            apply(events_.first[next_++]);
    }

private:
    Span<Timed> events_{};
    int next_ = 0;
};

// The events that a world has applied, each with its step. The room is that of the Recorder that it belongs to. An
// event for which there is no room overwrites the oldest one and is counted.
template <class N>
class Recording {
public:
    Recording(const Recording&) = delete;
    Recording& operator=(const Recording&) = delete;

    // Number of events that are kept.
    [[nodiscard]] int count() const { return count_; }
    // Event i of those that are kept, from the oldest.
    [[nodiscard]] const Event<N>& operator[](int i) const {
        TUMBLE_ASSERT(i >= 0 && i < count_);
        return ring_[place(i)];
    }
    // Number of events that have been overwritten since the start or clear(), held at 2^32 - 1.
    [[nodiscard]] std::uint32_t lost() const { return lost_; }
    // The events as a script for World::set_script(). A recording that has lost events is no script: asking for it is
    // misuse.
    [[nodiscard]] Span<Event<N>> script() const {
        TUMBLE_ASSERT(lost_ == 0);
        return {ring_, count_};
    }
    // Starts anew, for instance where the program takes a snapshot of the world.
    void clear() {
        first_ = count_ = 0;
        lost_ = 0;
    }
    // Forgets the events of `step` and of all later steps: call it where the world goes back to this step.
    void forget_from(std::uint64_t step) {
        while (count_ > 0 && ring_[place(count_ - 1)].step >= step) --count_;
    }
    // Appends an event that is applied before `step`. The world calls it.
    TUMBLE_INLINE void append(const Event<N>& event, std::uint64_t step) {
        Event<N>& kept = next();
        kept = event;
        kept.step = step;
    }

protected:
    // Writes into `ring`, which has room for `room` events.
    Recording(Event<N>* ring, int room) : ring_{ring}, room_{room} {}

private:
    [[gnu::noinline]] Event<N>& next() {
        if (count_ == room_) [[unlikely]] {
            first_ = place(1);
            --count_;
            if (lost_ != 0xffffffffu) ++lost_;
        }
        return ring_[place(count_++)];
    }
    [[nodiscard]] int place(int i) const { return i < room_ - first_ ? first_ + i : first_ + i - room_; }

    Event<N>* ring_;
    int room_, first_ = 0, count_ = 0;
    std::uint32_t lost_ = 0;
};

// A recording with room for this many events. World::record() attaches it.
template <class N, int room>
class Recorder : public Recording<N> {
    static_assert(room > 0, "room for one event at least");

public:
    Recorder() : Recording<N>{ring_, room} {}

private:
    Event<N> ring_[room]{};
};

}  // namespace tumble

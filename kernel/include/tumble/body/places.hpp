// Places<capacity>: which places of a world hold a body, and how often the body of a place has been removed. A new body
// takes the first free place, so the places of a world depend on its calls alone.
#pragma once

#include <tumble/body/id.hpp>

namespace tumble {

template <int capacity>
class Places {
public:
    // Calls visit with the members that a snapshot holds.
    template <class Self, class Visit>
    static void each(Self& self, Visit& visit) {
        visit(self.taken_, self.generation_, self.count_);
    }
    [[nodiscard]] int count() const { return count_; }
    [[nodiscard]] constexpr bool is_taken(int place) const { return place >= 0 && place < capacity && taken_[place]; }
    // False of the id of a body that has been removed.
    [[nodiscard]] bool contains(BodyId id) const {
        return is_taken(id.index()) && generation_[id.index()] == id.generation();
    }
    [[nodiscard]] BodyId id_of(int place) const { return {place, generation_[place]}; }
    // `capacity` where none is free.
    [[nodiscard]] constexpr int first_free() const {
        int place = 0;
        while (place < capacity && taken_[place]) ++place;
        return place;
    }
    [[nodiscard]] constexpr BodyId take(int place) {
        taken_[place] = true;
        ++count_;
        return {place, generation_[place]};
    }
    void leave(int place) {
        taken_[place] = false;
        --count_;
        ++generation_[place];
    }

private:
    bool taken_[capacity]{};
    std::uint16_t generation_[capacity]{};  // removals, modulo 2^16
    std::int16_t count_ = 0;
};

}  // namespace tumble

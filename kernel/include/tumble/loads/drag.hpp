// Linear drag: force -c v and torque -c w, the same for every body of the world. Depends on the body's own velocity.
#pragma once

#include <tumble/loads/loaded_body.hpp>

namespace tumble {

template <class N>
struct Drag {
    using Work = typename N::Work;

    Work linear{}, angular{};  // kg/s, N m s

    [[nodiscard]] bool acts() const { return linear > Work(0) || angular > Work(0); }
    void apply(LoadedBody<N>& body) const {
        body.force_w -= scaled_by(body.v_w, linear);
        body.torque_b -= scaled_by(body.w_b, angular);
    }
};

}  // namespace tumble

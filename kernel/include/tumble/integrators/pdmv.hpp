// Kick-drift-kick with the preprocessed discrete Moser-Veselov rotation: the most accurate free flight for its cost.
// Order 4 to 10 without torques. With torques the order is 2, because the kicks are of order 2.
#pragma once

#include <tumble/integrators/kick_drift_kick.hpp>
#include <tumble/integrators/rotation/moser_veselov.hpp>

namespace tumble::integrators {

template <int order_of_rotation>
struct Pdmv : KickDriftKick<MoserVeselovFlow<order_of_rotation>> {
    static constexpr int order = 2;
    static constexpr int free_order = order_of_rotation;
    static constexpr const char* needs = "division when the spin changes; sqrt and division a step in floating point";
};

// Order 4 for a free body, 2 with torques.
struct Pdmv4 : Pdmv<4> {
    static constexpr const char* name = "pdmv4";
};
// Order 6 for a free body, 2 with torques.
struct Pdmv6 : Pdmv<6> {
    static constexpr const char* name = "pdmv6";
};
// Order 8 for a free body, 2 with torques.
struct Pdmv8 : Pdmv<8> {
    static constexpr const char* name = "pdmv8";
};
// Order 10 for a free body, 2 with torques.
struct Pdmv10 : Pdmv<10> {
    static constexpr const char* name = "pdmv10";
};

}  // namespace tumble::integrators

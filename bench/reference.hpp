// What a method gets wrong in flight, against an integration in long double that shares no code with the kernel.
#pragma once

#include "scene_description.hpp"

#include <string>

namespace tumble::bench {

struct FlightError {
    double position_m = 0, orientation_rad = 0;   // the largest over all steps of the flight
    double until_s = 0;                           // the flight's end: the first contact, or the scene's end
};

// The first body of a scene whose loads are uniform gravity and scripted impulses, until it first touches a plane.
// Throws std::invalid_argument for scenes with other loads.
[[nodiscard]] FlightError flight_error(const host::SceneDescription& scene, const std::string& integrator, const std::string& numbers, bool carry);

}  // namespace tumble::bench

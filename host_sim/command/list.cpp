// `tumble list`.
#include <tumble/integrators/method.hpp>

#include <iomanip>
#include <iostream>

#include "command/command.hpp"
#include "firmware/firmware.hpp"
#include "scene/data.hpp"
#include "simulation/number_systems.hpp"

namespace tumble::host {
namespace {

template <class R>
void print_range(const char* name) {
    std::cout << "  " << std::left << std::setw(20) << name << R::position << " m, " << R::velocity << " m/s, "
              << R::spin << " rad/s\n";
}

// "2", or "2 (free 6)" where rotation without torques has another order.
std::string order_of(const IntegratorInfo& info) {
    std::string order = std::to_string(info.order);
    if (info.free_order == no_truncation) order += " (free exact)";
    else if (info.free_order != info.order) order += " (free " + std::to_string(info.free_order) + ")";
    return order;
}

int list() {
    std::cout << std::left << std::setw(22) << "integrators" << std::setw(16) << "order"
              << "needs, beyond what loads and contacts do; free: without torques\n";
    for (const IntegratorInfo& info : integrators()) {
        std::cout << "  " << std::setw(20) << info.name << std::setw(16) << order_of(info)
                  << (info.needs.empty() ? "-" : info.needs) << "\n";
        if (!info.not_in_fixed_point.empty())
            std::cout << std::setw(38) << ""
                      << "not in q32, because " << info.not_in_fixed_point << "\n";
    }
    std::cout << "\nnumber systems        with --carry on or off\n";
    std::string shown;
    for (const NumberSystemInfo& info : number_systems()) {
        if (info.name == shown) continue;
        shown = info.name;
        std::cout << "  " << std::setw(20) << info.name << info.what << "; carry is " << (info.carry ? "on" : "off")
                  << " by default\n";
    }
    std::cout << "\nranges                of q32; the smallest that holds the scene's [range] is used\n";
    Ranges::for_each([]<class Named>() { print_range<typename Named::Range>(Named::name); });
    std::cout << "\nlimits                of a scene on the host: " << max_bodies << " bodies, " << max_planes
              << " planes, " << max_springs << " springs, " << max_joints << " joints, " << max_near_pairs
              << " pairs near at one time\n";
    std::cout << "\njoints                kinds of [[joint]]\n                      ";
    for (const auto& [word, kind] : words<JointKind>)
        std::cout << (word == words<JointKind>.front().first ? "" : ", ") << word;
    std::cout << "\n\ncores                 machine of the emulator, and compiler flags\n";
    for (const Core& core : cores())
        std::cout << "  " << std::setw(20) << core.name << std::setw(24) << core.machine << core.flags << "\n";
    return done;
}

}  // namespace

void add_list(CommandLine& line) { line.add("list", "name the integrators, number systems, ranges and cores", list); }

}  // namespace tumble::host

// This kernel on the free top: every integrator of its list, in integers and in plain float and double.
#include "tumble_worlds.hpp"

#include <tumble/integrators/list.hpp>

void tumble::bench::add_tumble_tops(Contenders& contenders) {
    const auto add = [&]<class N>() {
        Integrators::for_each_in<N>([&]<class Method>() {
            add_tumble<N, Method>(contenders, [](auto&& f) { f.template operator()<Features{}>(); });
        });
    };
    add.template operator()<Q32<NearRange>>();
    add.template operator()<F32Plain>();
    add.template operator()<F64>();
}

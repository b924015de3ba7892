// Contacts of the Open Dynamics Engine, in its float or double.
#pragma once

#include <ode/ode.h>

namespace tumble::bench {

// Adds those of two shapes to the joints of a step.
inline void add_contacts(dWorldID world, dJointGroupID joints, dGeomID a, dGeomID b, dReal friction,
                         dReal restitution) {
    constexpr int most = 8;
    dContact contacts[most]{};
    const int count = dCollide(a, b, most, &contacts[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
        dSurfaceParameters& surface = contacts[i].surface;
        surface.mode = dContactBounce | dContactApprox1;
        surface.mu = friction;
        surface.bounce = restitution;
        dJointAttach(dJointCreateContact(world, joints, &contacts[i]), dGeomGetBody(a), dGeomGetBody(b));
    }
}

}  // namespace tumble::bench

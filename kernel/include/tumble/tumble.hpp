// tumble: rigid bodies on small hardware, the same bits everywhere. Includes everything a firmware needs.
#pragma once

#include <tumble/integrators/list.hpp>
#include <tumble/replay.hpp>
#include <tumble/version.hpp>
#include <tumble/world.hpp>

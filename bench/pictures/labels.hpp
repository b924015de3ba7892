// Places labels beside the ends of curves so that none overlaps another or leaves the frame. Lengths are pixels, y up.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tumble::bench {

struct Point {
    double x = 0, y = 0;
};
[[nodiscard]] inline double distance_between(const Point& a, const Point& b) {
    return std::hypot(b.x - a.x, b.y - a.y);
}

struct Box {
    Point low, high;

    [[nodiscard]] bool overlaps(const Box& other) const {
        return low.x < other.high.x && other.low.x < high.x && low.y < other.high.y && other.low.y < high.y;
    }
    [[nodiscard]] bool contains(const Box& other) const {
        return low.x <= other.low.x && other.high.x <= high.x && low.y <= other.low.y && other.high.y <= high.y;
    }
    [[nodiscard]] Point nearest(const Point& to) const {
        return {std::clamp(to.x, low.x, high.x), std::clamp(to.y, low.y, high.y)};
    }
    // The length of the segment from a to b that is inside.
    [[nodiscard]] double length_inside(const Point& a, const Point& b) const {
        double from = 0, to = 1;
        const auto clip = [&](double start, double change, double least, double most) {
            if (change == 0) {
                if (start < least || start > most) to = -1;
                return;
            }
            const double one = (least - start) / change, other = (most - start) / change;
            from = std::max(from, std::min(one, other));
            to = std::min(to, std::max(one, other));
        };
        clip(a.x, b.x - a.x, low.x, high.x);
        clip(a.y, b.y - a.y, low.y, high.y);
        return std::max(0.0, to - from) * distance_between(a, b);
    }
};

[[nodiscard]] inline bool cross(const Point& a, const Point& b, const Point& c, const Point& d) {
    const auto side = [](const Point& from, const Point& to, const Point& p) {
        return (to.x - from.x) * (p.y - from.y) - (to.y - from.y) * (p.x - from.x);
    };
    return side(a, b, c) * side(a, b, d) < 0 && side(c, d, a) * side(c, d, b) < 0;
}

struct LabelledPath {
    std::vector<Point> points;
    Point size;  // of its label
};

// A place for a label, and the cost of this place.
struct Candidate {
    Box box;
    double cost;
};

// The cost of a box for the label of path i: the distance from the path's end, and the paths that the box hides. The
// first `count` paths have labels.
[[nodiscard]] inline double cost_of_box(const std::vector<LabelledPath>& paths, std::size_t count, std::size_t i,
                                        const Box& box, double distance, double direction_x) {
    constexpr double away = 20;  // desired distance of a label from other paths
    const Point end = paths[i].points.back(), tip = box.nearest(end);
    double cost = distance + 4 * (1 - direction_x);  // a reader looks to the right first
    for (std::size_t p = 0; p < paths.size(); ++p) {
        const auto& points = paths[p].points;
        const double weight = p < count ? 10 : 1;
        double nearest = away;
        for (std::size_t k = 0; k < points.size(); ++k) {
            const Point &a = points[k > 0 ? k - 1 : 0], &b = points[k];
            cost += weight * box.length_inside(a, b);
            if (p >= count || p == i) continue;
            const Box marker{{b.x - 5, b.y - 5}, {b.x + 5, b.y + 5}};
            cost += (box.overlaps(marker) ? 40 : 0) + 5 * marker.length_inside(end, tip);
            nearest = std::min(nearest, distance_between(b, box.nearest(b)));
        }
        cost += away - nearest;  // a label must not seem to belong to another path
    }
    return cost;
}

// The places for the label of path i inside the frame. Throws std::runtime_error if there is none.
[[nodiscard]] inline std::vector<Candidate> candidates_of(const std::vector<LabelledPath>& paths, std::size_t count,
                                                          std::size_t i, const Box& frame) {
    std::vector<Candidate> candidates;
    const Point end = paths[i].points.back(), half{paths[i].size.x / 2, paths[i].size.y / 2};
    for (double distance = 8; distance < 200; distance *= 1.25) {
        for (int direction = 0; direction < 24; ++direction) {
            const double angle = 2 * std::numbers::pi * direction / 24, x = std::cos(angle), y = std::sin(angle);
            // The middle is so far out that the border has the distance.
            const double out = std::min(half.x / std::max(std::abs(x), 1e-9), half.y / std::max(std::abs(y), 1e-9));
            const Point middle{end.x + (out + distance) * x, end.y + (out + distance) * y};
            const Box box{{middle.x - half.x, middle.y - half.y}, {middle.x + half.x, middle.y + half.y}};
            if (frame.contains(box)) candidates.push_back({box, cost_of_box(paths, count, i, box, distance, x)});
        }
    }
    if (candidates.empty()) throw std::runtime_error{"a label is larger than its panel"};
    return candidates;
}

// Boxes for the labels of the first paths, beside the paths' ends: as near as the other labels allow. They hide as
// little of each path as possible. Throws std::runtime_error if there is no room.
[[nodiscard]] inline std::vector<Box> place_labels(const std::vector<LabelledPath>& paths, std::size_t count,
                                                   const Box& frame) {
    std::vector<std::vector<Candidate>> candidates;
    for (std::size_t i = 0; i < count; ++i) candidates.push_back(candidates_of(paths, count, i, frame));
    // One label after the other moves to its best place among the others, until none moves. Overlap is expensive on the
    // way, not forbidden. Each label is once the first to move; the cheapest result is taken.
    constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();
    using Places = std::vector<std::size_t>;
    const auto cost_of = [&](const Places& places, std::size_t i, std::size_t place) {
        const Candidate& at = candidates[i][place];
        double cost = at.cost;
        for (std::size_t k = 0; k < count; ++k) {
            if (k == i || places[k] == nowhere) continue;
            const Box& other = candidates[k][places[k]].box;
            const Point end = paths[i].points.back(), other_end = paths[k].points.back();
            if (at.box.overlaps(other)) cost += 1000;
            const Point tip = at.box.nearest(end), other_tip = other.nearest(other_end);
            if (cross(end, tip, other_end, other_tip)) cost += 50;
            cost += 20 * other.length_inside(end, tip) + 20 * at.box.length_inside(other_end, other_tip);
        }
        return cost;
    };
    Places best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t first = 0; first < count; ++first) {
        Places places(count, nowhere);
        bool moved = true;
        for (int pass = 0; moved && pass < 100; ++pass) {
            moved = false;
            for (std::size_t n = 0; n < count; ++n) {
                const std::size_t i = (first + n) % count;
                std::size_t cheapest = 0;
                double lowest = std::numeric_limits<double>::infinity();
                for (std::size_t place = 0; place < candidates[i].size(); ++place) {
                    const double cost = cost_of(places, i, place);
                    if (cost < lowest) lowest = cost, cheapest = place;
                }
                moved = moved || cheapest != places[i];
                places[i] = cheapest;
            }
        }
        double sum = 0;
        for (std::size_t i = 0; i < count; ++i) sum += cost_of(places, i, places[i]);
        if (sum < least) least = sum, best = places;
    }
    std::vector<Box> boxes;
    for (std::size_t i = 0; i < count; ++i) {
        const Box& box = candidates[i][best[i]].box;
        for (const Box& other : boxes)
            if (box.overlaps(other)) throw std::runtime_error{"labels overlap"};
        boxes.push_back(box);
    }
    return boxes;
}

}  // namespace tumble::bench

#include "page/session.hpp"

#include <algorithm>
#include <array>

#include <tumble/version.hpp>

#include "scene/data.hpp"
#include "scene/edit.hpp"
#include "scene/reader.hpp"
#include "scene/toml.hpp"
#include "scene/writer.hpp"
#include "tools/text.hpp"

namespace tumble::host {
namespace {

// What follows it in a saved session was made by the player.
constexpr std::string_view marker = "\n# The session: hits of the player, and how it ended.\n";
constexpr std::size_t most_kept = 32;  // snapshots of a run; one of 64 bodies takes about 1 MB

// The scene before the marker. None where there is no marker, or where a person has added more than hits after it.
std::optional<SceneDescription> part_before_marker(const std::string& text, const SceneDescription& whole) {
    const std::size_t end = text.rfind(marker);
    if (end == std::string::npos || !toml::parse(std::string_view(text).substr(0, end))) return {};
    SceneDescription part = read_scene_text(text.substr(0, end), whole.path);
    const auto sizes = [](const SceneDescription& scene) {
        return std::array{scene.bodies.size(), scene.planes.size(), scene.springs.size(),
                          scene.joints.size(), scene.forces.size(), scene.events.size()};
    };
    if (sizes(part) != sizes(whole)) return {};
    return part;
}

}  // namespace

Run::Run(std::unique_ptr<Simulation> simulation, int halvings)
    : simulation_(std::move(simulation)), halvings_{halvings} {
    keep();
}

std::int64_t Run::own_step(std::int64_t step) const { return halvings_ >= 0 ? step << halvings_ : step >> -halvings_; }
std::int64_t Run::acting_step(std::int64_t step) const {
    return halvings_ >= 0 ? step << halvings_ : -(-step >> -halvings_);
}

void Run::keep() {
    const std::int64_t now = simulation_->steps_taken();
    if (now % spacing_ != 0 || (!kept_.empty() && kept_.back().step >= now)) return;
    kept_.push_back({now, simulation_->snapshot()});
    if (kept_.size() <= most_kept) return;
    spacing_ *= 2;
    std::erase_if(kept_, [&](const Kept& kept) { return kept.step % spacing_ != 0; });
}

bool Run::go_to(std::int64_t step, const std::vector<Hit>& hits, int most) {
    const std::int64_t target = own_step(step);
    if (target < simulation_->steps_taken()) {
        const auto after = std::find_if(kept_.begin(), kept_.end(), [&](const Kept& k) { return k.step > target; });
        simulation_->restore(*std::prev(after)->snapshot);
    }
    auto hit = std::find_if(hits.begin(), hits.end(),
                            [&](const Hit& h) { return acting_step(h.step) >= simulation_->steps_taken(); });
    for (; simulation_->steps_taken() < target && most > 0; --most) {
        for (; hit != hits.end() && acting_step(hit->step) == simulation_->steps_taken(); ++hit) {
            const ImpulseDescription& i = hit->impulse;
            simulation_->apply({0, EventKind::impulse, i.body, i.frame, i.impulse, i.point});
            if (i.angular_impulse != Triple{})
                simulation_->apply({0, EventKind::angular_impulse, i.body, i.frame, i.angular_impulse});
        }
        simulation_->step();
        keep();
    }
    return simulation_->steps_taken() == target;
}

void Run::forget_after(std::int64_t step) {
    const std::int64_t last = acting_step(step);
    while (kept_.back().step > last) kept_.pop_back();
    if (simulation_->steps_taken() > last) simulation_->restore(*kept_.back().snapshot);
}

Session::Session(std::string text, std::string_view name) : text_(std::move(text)) {
    scene_ = read_scene_text(text_, name);
    if (const std::optional<SceneDescription> own = part_before_marker(text_, scene_)) {
        for (std::size_t i = own->impulses.size(); i < scene_.impulses.size(); ++i)
            hits_.push_back({nearest_step(scene_.impulses[i].time, scene_.step), scene_.impulses[i]});
        scene_.impulses = own->impulses;
        text_.resize(text_.rfind(marker));
    }
    if (scene_.expected) saved_steps_ = scene_.expected->steps;
    text_ = without_expectation(text_);
    (void)build_scene(scene_);
}

RunWay Session::saved_way() const {
    if (!scene_.expected) return {"verlet", "q32"};
    const Expectation& e = *scene_.expected;
    return {e.integrator, e.numbers, e.carry.value_or(default_carry(e.numbers))};
}

std::string Session::obstacle(const RunWay& way) const {
    const IntegratorInfo& integrator = find_integrator(way.integrator);
    if (!runs_in(integrator, way.numbers))
        return way.integrator + " does not run in " + way.numbers + ", because " + integrator.not_in_fixed_point;
    if (!has_range_for(scene_, way.numbers)) return scene_.range.beyond_default->what();
    if (!is_compiled(scene_, way.integrator, way.numbers, way.carry))
        return "this page has no " + numbers_text(way.numbers, way.carry) + " of the range of this scene";
    return {};
}

std::size_t Session::add(const RunWay& way) {
    SceneDescription scene = scene_;
    scene.step = scaled(scene.step, -way.halvings);
    // What acts does so at a step of the scene, in a run of another step too.
    for_each_time(scene, [&](double& time) {
        time = static_cast<double>(nearest_step(time, scene_.step)) * scene_.step.seconds();
    });
    runs_.emplace_back(make_simulation(scene, way.integrator, way.numbers, way.carry), way.halvings);
    return runs_.size() - 1;
}

bool Session::go_to(std::size_t index, std::int64_t step, int most) {
    const bool is_there = runs_.at(index).go_to(step, hits_, most);
    furthest_ = std::max(furthest_, run(0).steps_taken());
    return is_there;
}

bool Session::acts(std::int64_t step) const {
    const auto is_now = [&](const auto& event) { return nearest_step(event.time, scene_.step) == step; };
    return std::any_of(scene_.impulses.begin(), scene_.impulses.end(), is_now) ||
           std::any_of(scene_.events.begin(), scene_.events.end(), is_now);
}

std::int64_t Session::hit(const ImpulseDescription& impulse) {
    std::int64_t step = run(0).steps_taken();
    for (Run& run : runs_) run.forget_after(step);
    while (acts(step)) ++step;
    // Hits of this very step are of another future where the player has come back to it.
    const bool has_come_back = run(0).steps_taken() < furthest_;
    std::erase_if(hits_, [&](const Hit& hit) { return has_come_back ? hit.step >= step : hit.step > step; });
    furthest_ = run(0).steps_taken();
    Hit hit{step, impulse};
    if (scene_.body(impulse.body).is_point_mass()) {  // it has no axes and no arm: the reader takes neither
        hit.impulse.frame = Frame::world;
        hit.impulse.point = hit.impulse.angular_impulse = {};
    }
    hit.impulse.time = static_cast<double>(step) * scene_.step.seconds();
    hits_.insert(
        std::upper_bound(hits_.begin(), hits_.end(), hit, [](const Hit& a, const Hit& b) { return a.step < b.step; }),
        hit);
    return step;
}

std::string Session::text() const {
    const Simulation& played = run(0);
    const std::int64_t steps = played.steps_taken();
    SceneDescription anew = scene_;
    anew.duration = static_cast<double>(steps) * scene_.step.seconds();
    const double duration = anew.duration = readable_duration(anew);
    const Expectation ending{std::string(played.integrator()),
                             std::string(played.numbers()),
                             played.carry(),
                             steps,
                             TUMBLE_BITS,
                             played.hash()};
    std::string session(marker);
    for (const Hit& hit : hits_)
        if (hit.step < steps) session += impulse_text(hit.impulse, scene_);
    session += expectation_text(ending);

    std::string text = with_value(text_, "world", "duration", cpp_number(duration));
    if (!text.ends_with('\n')) text += '\n';
    text += session;
    // Text that cannot be edited so, such as impulses in an inline array, is written anew.
    if (const toml::parse_result written = toml::parse(text);
        written && written["world"]["duration"].value<double>() == duration &&
        written["expect"]["hash"].value<std::string>() == hex(ending.hash))
        return text;
    anew.expected.reset();
    return scene_text(anew) + session;
}

}  // namespace tumble::host

#pragma once

#include "simulation/simulation.hpp"

#include <cmath>
#include <memory>
#include <utility>

namespace tumble::host {

// A simulation that tells what is not so: after the start `energy` times the kinetic energy, and places cut to
// multiples of 1/digits.
class Liar final : public Simulation {
public:
    Liar(std::unique_ptr<Simulation> run, double energy, double digits)
        : Simulation(run->steps(), run->step_length()), run_{std::move(run)}, energy_{energy}, digits_{digits} {}

    void step() override { run_->step(); }
    void apply(const EventDescription& event) override { run_->apply(event); }
    std::unique_ptr<Snapshot> snapshot() const override { return run_->snapshot(); }
    void restore(const Snapshot& snapshot) override { run_->restore(snapshot); }
    ImuSnapshot imu(int index) const override { return run_->imu(index); }
    std::vector<ContactSnapshot> contacts() const override { return run_->contacts(); }
    JointSnapshot joint(int index) const override { return run_->joint(index); }
    std::int64_t steps_taken() const override { return run_->steps_taken(); }
    std::uint64_t hash() const override { return run_->hash(); }
    int body_count() const override { return run_->body_count(); }
    BodySnapshot body(int index) const override {
        BodySnapshot body = run_->body(index);
        for (auto* numbers : {body.position.data(), body.orientation.data()})
            for (int i = 0; i < 3; ++i) numbers[i] = std::floor(numbers[i] * digits_) / digits_;
        return body;
    }
    Energy energy() const override {
        Energy energy = run_->energy();
        if (steps_taken() > 0) energy.kinetic *= energy_;
        return energy;
    }
    const std::vector<Trouble>& troubles() const override { return run_->troubles(); }
    long double largest_safe_step() const override { return run_->largest_safe_step(); }
    long double contact_tolerance() const override { return run_->contact_tolerance(); }
    bool stepped_bounded(int body) const override { return run_->stepped_bounded(body); }
    double deepest_overlap() const override { return run_->deepest_overlap(); }
    int most_near_pairs() const override { return run_->most_near_pairs(); }
    double held_spin(int body) const override { return run_->held_spin(body); }
    void append_words(std::vector<std::uint32_t>& words) const override { run_->append_words(words); }
    Place place_of_word(std::size_t index) const override { return run_->place_of_word(index); }
    std::string_view integrator() const override { return run_->integrator(); }
    std::string_view numbers() const override { return run_->numbers(); }
    std::string_view range() const override { return run_->range(); }
    bool carry() const override { return run_->carry(); }

private:
    std::unique_ptr<Simulation> run_;
    double energy_, digits_;
};

}  // namespace tumble::host

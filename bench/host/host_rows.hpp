// Queries of the rows of bench/host, for tables and pictures.
#pragma once

#include "rows/rows.hpp"

namespace tumble::bench {

class HostRows {
public:
    explicit HostRows(std::vector<Row> rows) : rows_(std::move(rows)) {}

    // In the order of their first rows: scenes of one size or of several, engines of a scene without this kernel, and
    // numbers of bodies of a scene.
    [[nodiscard]] std::vector<std::string> scenes(bool of_several_sizes) const {
        std::vector<std::string> names = distinct<std::string>("scene", [](const Row&) { return true; });
        std::erase_if(names, [&](const std::string& name) { return (sizes(name).size() > 1) != of_several_sizes; });
        return names;
    }
    [[nodiscard]] std::vector<std::string> engines(const std::string& scene) const {
        return distinct<std::string>("engine",
                                     [&](const Row& r) { return r.at("scene") == scene && r.at("engine") != own; });
    }
    [[nodiscard]] std::vector<int> sizes(const std::string& scene) const {
        return distinct<int>("bodies", [&](const Row& r) { return r.at("scene") == scene; });
    }
    [[nodiscard]] std::vector<int> sizes() const {
        return distinct<int>("bodies", [](const Row&) { return true; });
    }
    // This kernel's row; null if there is none.
    [[nodiscard]] const Row* kernel(const std::string& scene, int bodies, const std::string& numbers,
                                    const std::string& method) const {
        for (const Row& row : rows_)
            if (is(row, scene, bodies, own) && numbers_of(row) == numbers && row.at("integrator") == method)
                return &row;
        return nullptr;
    }
    // An engine's fastest row; the first if none has a time; null if there is none.
    [[nodiscard]] const Row* fastest(const std::string& scene, int bodies, const std::string& engine) const {
        const Row* best = nullptr;
        for (const Row& row : rows_) {
            if (!is(row, scene, bodies, engine)) continue;
            if (best == nullptr || (row.contains(time) && (!best->contains(time) || row.at(time) < best->at(time))))
                best = &row;
        }
        return best;
    }

    static constexpr const char *own = "tumble", *time = "ns_per_body_step";

private:
    [[nodiscard]] static bool is(const Row& row, const std::string& scene, int bodies, const std::string& engine) {
        return row.at("scene") == scene && row.at("bodies") == bodies && row.at("engine") == engine;
    }
    template <class T, class F>
    [[nodiscard]] std::vector<T> distinct(const char* key, F&& counts) const {
        std::vector<T> values;
        for (const Row& row : rows_)
            if (const T value = row.at(key);
                counts(row) && std::find(values.begin(), values.end(), value) == values.end())
                values.push_back(value);
        return values;
    }

    std::vector<Row> rows_;
};

// Draws the time of a step against the number of bodies. Throws std::runtime_error.
void draw_host(const HostRows& rows, const std::filesystem::path& svg);

}  // namespace tumble::bench

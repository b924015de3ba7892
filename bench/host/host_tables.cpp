#include "host/host_tables.hpp"

#include "host/host_rows.hpp"

namespace tumble::bench {
namespace {

// A ratio of times: two digits, or all before the point.
std::string ratio_text(double ratio) { return text(ratio < 9.95 ? "%.2g" : "%.0f", ratio); }
std::string ratio_to(const Row* row, const std::string& engine) {
    if (row == nullptr || !row->contains("time_ratios") || !row->at("time_ratios").contains(engine)) return "-";
    return ratio_text(row->at("time_ratios").at(engine).get<double>());
}

// Many bodies: a line a scene and name of names(scene), a column a number of bodies.
Table many_table(const HostRows& rows, const Strings& head, const auto& names, const auto& cell) {
    Table table{head, {}};
    for (const int bodies : rows.sizes()) table.head.push_back(std::to_string(bodies));
    for (const std::string& scene : rows.scenes(true)) {
        for (const std::string& name : names(scene)) {
            Strings line{scene, name};
            for (const int bodies : rows.sizes()) line.push_back(cell(scene, name, bodies));
            table.lines.push_back(line);
        }
    }
    return table;
}

}  // namespace

Table host_table(const Rows& all) {
    const HostRows rows{all};
    constexpr const char* variants[][2]{{"q32 carry", "verlet"}, {"q32 carry", "rk4"}, {"f32 plain", "verlet"},
                                        {"f32 plain", "rk4"},    {"f64", "verlet"},    {"f64", "rk4"}};
    Table table{{"problem", "time, divided by that of", "its error, m"}, {}};
    for (const auto& [numbers, name] : variants) table.head.push_back(in_code(name) + " " + numbers);
    for (const std::string& scene : rows.scenes(false)) {
        const auto add = [&](Strings line, const auto& cell) {
            for (const auto& [numbers, name] : variants)
                line.push_back(cell(rows.kernel(scene, rows.sizes(scene).front(), numbers, name)));
            table.lines.push_back(line);
        };
        add({scene, "errors of this kernel, m", ""},
            [](const Row* own) { return own == nullptr ? "-" : text_of(*own, "position_error_m"); });
        for (const std::string& engine : rows.engines(scene)) {
            const Row& peer = *rows.fastest(scene, rows.sizes(scene).front(), engine);
            add({"", engine_name(peer) + ", " + text_of(peer, "integrator") + ", " + numbers_of(peer),
                 peer.contains("failure") ? "wrong" : text_of(peer, "position_error_m")},
                [&](const Row* own) { return ratio_to(own, engine); });
        }
    }
    return table;
}

Table host_many_table(const Rows& all) {
    const HostRows rows{all};
    const auto cell = [&](const std::string& scene, const std::string& engine, int bodies) {
        Strings ratios;
        for (const std::string& n : systems)
            ratios.push_back(ratio_to(rows.kernel(scene, bodies, n, "verlet"), engine));
        const std::string all = ratios[0] + " / " + ratios[1] + " / " + ratios[2];
        return all == "- / - / -" ? "-" : all;
    };
    return many_table(
        rows, {"q32 carry / f32 plain / f64", "time, divided by that of"},
        [&](const std::string& scene) { return rows.engines(scene); }, cell);
}

Table host_growth_table(const Rows& all) {
    const HostRows rows{all};
    const auto names = [&](const std::string& scene) {
        Strings all;
        for (const std::string& n : systems) all.push_back("tumble " + n);
        for (const std::string& engine : rows.engines(scene)) all.push_back(engine);
        return all;
    };
    const auto row_of = [&](const std::string& scene, const std::string& name, int bodies) {
        return name.starts_with("tumble ") ? rows.kernel(scene, bodies, name.substr(7), "verlet")
                                           : rows.fastest(scene, bodies, name);
    };
    return many_table(rows, {"time a body, divided by that of one", "whose"}, names,
                      [&](const std::string& scene, const std::string& name, int bodies) -> std::string {
                          const Row *one = row_of(scene, name, 1), *row = row_of(scene, name, bodies);
                          const char* time = HostRows::time;
                          if (one == nullptr || row == nullptr || !one->contains(time) || !row->contains(time))
                              return "-";
                          return ratio_text(row->at(time).get<double>() / one->at(time).get<double>());
                      });
}

}  // namespace tumble::bench

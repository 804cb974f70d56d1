// One recorded run: bodies, their shapes and joints, and at every recorded frame their poses and contacts.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "lines.hpp"
#include "parts.hpp"

namespace samples {

/// What a scene is, told before its first frame.
struct scene_settings {
    std::string title;      ///< Runs with one title and dimension are shown together, to compare them.
    std::string scalar;     ///< The name of the run within its title, for example "float".
    int dimension = 3;      ///< 2 or 3.
    double dt = 1.0 / 60;   ///< Seconds a step.
    int every = 2;          ///< Steps from one recorded frame to the next; the page interpolates.
    double resolution = 0;  ///< Metres, the grid of stored positions; 0: about 1/1000 of the smallest moving shape.
    char up = 'y';          ///< The axis that points up in 3D: 'y' or 'z'.
    bool drawing = false;   ///< Lines of debug drawing are stored too.
};

/// One recorded run. Add its bodies and joints, then for every recorded state: `place` all bodies that may have moved,
/// `add` the contacts, `commit`. The first state is the start, before any step. Motion is stored as the difference
/// from a prediction (go on as before), so that a body at rest costs a thousandth of a bit or so a frame.
class recorded_scene {
public:
    explicit recorded_scene(scene_settings settings) : settings_(std::move(settings)) {
        if (settings_.dimension != 2 && settings_.dimension != 3) {
            refuse("dimension", settings_.dimension, "must be 2 or 3");
        }
        if (!(settings_.dt > 0)) refuse("dt", settings_.dt, "must be above zero");
        if (settings_.every < 1) refuse("every", settings_.every, "must be 1 or more");
        if (settings_.up != 'y' && settings_.up != 'z') refuse("up", settings_.up, "must be 'y' or 'z'");
    }

    /// A row of the run's table, both as the page shows them: ("ms a step", "0.42"). May be told at any time.
    void fact(std::string label, std::string text) { facts_.emplace_back(std::move(label), std::move(text)); }

    /// Adds a body before the first frame, and returns its number: 0, 1, 2...
    int add_body(motion kind, const std::vector<shape>& shapes, pose start = {}) {
        if (frames_ > 0) throw std::logic_error("samples: add_body: the recording has begun");
        std::string text = "[" + std::to_string(static_cast<int>(kind));
        for (const shape& part : shapes) {
            text += ",[" + detail::quoted((part.hollow ? "~" : "") + std::string(part.form));
            for (double size : part.size) text += "," + detail::number(size);
            const pose& at = part.local;
            for (double value : {at.x, at.y, at.z, at.qx, at.qy, at.qz, at.qw}) text += "," + detail::number(value);
            text += "]";
            const bool has_size = part.form == "sphere" || part.form == "capsule" || part.form == "box";
            if (kind != motion::fixed && has_size) {
                for (std::size_t i = 0; i < part.size.size(); ++i)
                    if (part.size[i] > 0 && part.size[i] < smallest_) smallest_ = part.size[i];
            }
        }
        text += "]";
        const auto found = kinds_.emplace(text, static_cast<int>(kinds_.size()));
        if (found.second) kind_texts_.push_back(text);
        body fresh;
        fresh.kind = found.first->second;
        fresh.moves = kind != motion::fixed;
        bodies_.push_back(fresh);
        place(static_cast<int>(bodies_.size()) - 1, start);
        return static_cast<int>(bodies_.size()) - 1;
    }

    /// Adds a joint between two bodies before the first frame, from a point in the one's frame to one in the other's.
    void add_joint(int body_a, const pose& point_a, int body_b, const pose& point_b) {
        if (frames_ > 0) throw std::logic_error("samples: add_joint: the recording has begun");
        for (int number : {body_a, body_b}) static_cast<void>(bodies_.at(static_cast<std::size_t>(number)));
        std::string text = std::to_string(body_a) + "," + std::to_string(body_b);
        for (double value : {point_a.x, point_a.y, point_a.z, point_b.x, point_b.y, point_b.z}) {
            if (!std::isfinite(value)) refuse("point of a joint", value, "must be finite");
            text += "," + detail::number(value, 6);
        }
        joint_texts_.push_back("[" + text + "]");
    }

    /// Says that a body is seen in the frames from one to another alone, and in others of which that is said.
    void show(int body_number, int from, int to) {
        static_cast<void>(bodies_.at(static_cast<std::size_t>(body_number)));
        span_texts_.push_back("[" + std::to_string(body_number) + "," + std::to_string(from) + "," +
                              std::to_string(to) + "]");
    }

    /// True for the steps to record, so that a program can skip the work for the others. Step 0 is the start.
    [[nodiscard]] bool due(long step) const { return step % settings_.every == 0; }

    /// Says where a body is in the frame to come; a body that is not placed stays where it was.
    void place(int body_number, const pose& at) {
        for (double value : {at.x, at.y, at.z, at.qx, at.qy, at.qz, at.qw})
            if (!std::isfinite(value)) refuse("pose of body " + std::to_string(body_number), value, "must be finite");
        bodies_.at(static_cast<std::size_t>(body_number)).at = at;
    }

    /// Adds a contact to the frame to come.
    void add(const touch& contact) {
        for (double value : {contact.x, contact.y, contact.z, contact.nx, contact.ny, contact.nz, contact.impulse})
            if (!std::isfinite(value)) refuse("contact", value, "must be finite");
        touches_.push_back(contact);
    }

    /// Whether lines and tints are stored.
    [[nodiscard]] bool draws() const { return settings_.drawing; }
    /// Adds a line of debug drawing to the frame to come.
    void draw(const drawn_line& line) {
        if (!settings_.drawing) throw std::logic_error("samples: draw: the scene stores no drawing");
        for (const auto& end : {line.from, line.to})
            for (const double value : end)
                if (!std::isfinite(value)) refuse("line", value, "must be finite");
        static_cast<void>(bodies_.at(static_cast<std::size_t>(std::max(line.body, 0))));
        drawn_.push_back(line);
    }
    /// Gives a body a colour in debug drawing, 0xrrggbb, from the frame to come on.
    void tint(int body_number, std::uint32_t colour) {
        bodies_.at(static_cast<std::size_t>(body_number)).tint = colour;
    }

    /// Stores the frame.
    void commit() {
        if (frames_ == 0) choose_grid();
        for (body& one : bodies_) {
            if (one.moves || frames_ == 0) put_body(one);
        }
        put_touches();
        touches_.clear();
        if (settings_.drawing) put_lines();
        drawn_.clear();
        ++frames_;
    }

    [[nodiscard]] int frames() const { return frames_; }

    /// The scene as JSON; the recording of its frames ends here.
    [[nodiscard]] std::string json() {
        if (packed_.empty()) packed_ = detail::base64(out_.finish());
        std::string text = "{\"title\":" + detail::quoted(settings_.title);
        text += ",\"scalar\":" + detail::quoted(settings_.scalar);
        const auto field = [&](const char* name, double value) {
            text += std::string(",\"") + name + "\":" + detail::number(value, 17);
        };
        field("dimension", settings_.dimension);
        field("dt", settings_.dt);
        field("every", settings_.every);
        field("frames", frames_);
        field("grid", grid_);
        field("turn", turn_grid());
        text += ",\"check\":" + std::to_string(check_) + ",\"up\":\"" + std::string(1, settings_.up) + "\",\"facts\":[";
        for (std::size_t i = 0; i < facts_.size(); ++i)
            text += (i ? ",[" : "[") + detail::quoted(facts_[i].first) + "," + detail::quoted(facts_[i].second) + "]";
        text += "],\"kinds\":[";
        for (std::size_t i = 0; i < kind_texts_.size(); ++i) text += (i ? "," : "") + kind_texts_[i];
        text += "],\"bodies\":[";
        for (std::size_t i = 0; i < bodies_.size(); ++i) text += (i ? "," : "") + std::to_string(bodies_[i].kind);
        text += "],\"joints\":[";
        for (std::size_t i = 0; i < joint_texts_.size(); ++i) text += (i ? "," : "") + joint_texts_[i];
        text += "],\"spans\":[";
        for (std::size_t i = 0; i < span_texts_.size(); ++i) text += (i ? "," : "") + span_texts_[i];
        if (settings_.drawing)
            text += "],\"lines\":" + std::to_string(lines_.total()) + ",\"palette\":[" + lines_.palette();
        return text + "],\"data\":\"" + packed_ + "\"}";
    }

private:
    static constexpr std::size_t most_channels = 7;
    /// Steps of the grid from one place of a line to the next.
    static constexpr double line_steps = 16;
    using quanta = std::array<std::int32_t, most_channels>;

    struct body {
        pose at;
        int kind = 0;
        std::uint32_t tint = 0x808080;
        bool moves = false, moved = false;
        quanta now{}, before{}, size{};
    };
    struct stored_touch {
        quanta now{}, change{}, size{};
        bool moved = true;
    };

    [[noreturn]] static void refuse(const std::string& field, double value, const std::string& rule) {
        throw std::invalid_argument("samples: recording: " + field + " is " + detail::number(value) + "; it " + rule);
    }

    [[nodiscard]] double turn_grid() const { return settings_.dimension == 2 ? 1.0 / 4096 : 1.0 / 8192; }

    void choose_grid() {
        grid_ = settings_.resolution > 0 ? settings_.resolution : std::exp2(std::floor(std::log2(smallest_ / 900)));
    }

    [[nodiscard]] std::int32_t rounded(double value, double grid) const {
        const double steps = std::nearbyint(value / grid);
        if (!(std::fabs(steps) < 5e8)) refuse("position", value, "is too far for the resolution of the recording");
        return static_cast<std::int32_t>(steps);
    }

    /// Codes the difference, with a model chosen by the channel and by how large the last difference was.
    void put(std::size_t channel, std::int32_t difference, std::int32_t& size) {
        detail::put_number(out_, models_[channel * 8 + static_cast<std::size_t>(size)], difference);
        const auto bits = static_cast<int>(std::bit_width(static_cast<std::uint32_t>(std::abs(difference))));
        size = bits < 7 ? bits : 7;
    }
    void note(std::int32_t value) { check_ = (check_ ^ static_cast<std::uint32_t>(value)) * 16777619u; }

    void put_body(body& one) {
        const bool plane = settings_.dimension == 2;
        const std::size_t count = plane ? 3 : 7;
        quanta next{};
        next[0] = rounded(one.at.x, grid_);
        next[1] = rounded(one.at.y, grid_);
        if (plane) {
            // The angle that is nearest to the one before, so that a rolling disc does not jump by a turn.
            constexpr double turn = 6.283185307179586;
            const double angle = 2 * std::atan2(one.at.qz, one.at.qw), former = one.now[2] * turn_grid();
            next[2] = rounded(angle + turn * std::nearbyint((former - angle) / turn), turn_grid());
        } else {
            next[2] = rounded(one.at.z, grid_);
            const std::array<double, 4> q = {one.at.qx, one.at.qy, one.at.qz, one.at.qw};
            double same = 0;
            for (std::size_t i = 0; i < 4; ++i) same += q[i] * one.now[3 + i];
            for (std::size_t i = 0; i < 4; ++i) next[3 + i] = rounded(same < 0 ? -q[i] : q[i], turn_grid());
        }
        const bool moved = next != one.now || one.now != one.before;
        out_.put(moved, moved_[one.moved]);
        if (moved) {
            for (std::size_t i = 0; i < count; ++i)
                put(i, next[i] - (frames_ == 0 ? 0 : 2 * one.now[i] - one.before[i]), one.size[i]);
        }
        one.moved = moved;
        one.before = frames_ == 0 ? next : one.now;
        one.now = next;
        for (std::size_t i = 0; i < count; ++i) note(next[i]);
    }

    [[nodiscard]] quanta quantised(const touch& contact) const {
        quanta q{};
        const double coarse = 4 * grid_;
        q[0] = rounded(contact.x, coarse);
        q[1] = rounded(contact.y, coarse);
        q[2] = rounded(contact.z, coarse);
        q[3] = rounded(contact.nx, 1.0 / 64);
        q[4] = rounded(contact.ny, 1.0 / 64);
        q[5] = rounded(contact.nz, 1.0 / 64);
        // Three levels an octave, from 2^-20 to 2^40 N s; -61 stands for no impulse.
        const double level = contact.impulse > 0 ? std::nearbyint(3 * std::log2(contact.impulse)) : -61;
        q[6] = static_cast<std::int32_t>(level < -60 ? -61 : level > 120 ? 120 : level);
        return q;
    }

    /// Contacts that are near one of the frame before continue it, so that the page can move them smoothly.
    void put_touches() {
        const std::int32_t reach = rounded(smallest_ * 0.5, 4 * grid_) + 1;
        const auto cell_key = [&](std::int32_t x, std::int32_t y, std::int32_t z) {
            const auto wide = [](std::int32_t value) { return static_cast<std::uint64_t>(value); };
            return (wide(x) * 0x9e3779b97f4a7c15u) ^ (wide(y) * 0xc2b2ae3d27d4eb4fu) ^ (wide(z) * 0x165667b19e3779f9u);
        };
        const auto cell = [&](std::int32_t value) { return (value >= 0 ? value : value - reach + 1) / reach; };
        std::unordered_map<std::uint64_t, std::vector<std::size_t>> cells;
        for (std::size_t i = 0; i < stored_.size(); ++i) {
            const quanta& at = stored_[i].now;
            cells[cell_key(cell(at[0]), cell(at[1]), cell(at[2]))].push_back(i);
        }
        std::vector<quanta> next(touches_.size());
        std::vector<std::size_t> heir(stored_.size(), touches_.size()), fresh;
        for (std::size_t t = 0; t < touches_.size(); ++t) {
            next[t] = quantised(touches_[t]);
            const quanta& q = next[t];
            std::size_t best = stored_.size();
            std::int64_t nearest = static_cast<std::int64_t>(reach) * reach;
            for (int n = 0; n < 27; ++n) {
                const auto found =
                    cells.find(cell_key(cell(q[0]) + n % 3 - 1, cell(q[1]) + n / 3 % 3 - 1, cell(q[2]) + n / 9 - 1));
                if (found == cells.end()) continue;
                for (std::size_t i : found->second) {
                    const quanta& old = stored_[i].now;
                    std::int64_t apart = 0;
                    for (std::size_t k = 0; k < 3; ++k)
                        apart += static_cast<std::int64_t>(q[k] - old[k]) * (q[k] - old[k]);
                    const bool alike = q[3] * old[3] + q[4] * old[4] + q[5] * old[5] > 64 * 48;
                    if (apart < nearest && alike && heir[i] == touches_.size()) nearest = apart, best = i;
                }
            }
            if (best == stored_.size()) fresh.push_back(t);
            else heir[best] = t;
        }
        std::vector<stored_touch> now;
        for (std::size_t i = 0; i < stored_.size(); ++i) {
            const bool alive = heir[i] < touches_.size();
            out_.put(alive, alive_);
            if (!alive) continue;
            now.push_back(stored_[i]);
            quanta& q = next[heir[i]];
            // A level that wavers between two neighbours keeps the former one.
            if (std::abs(q[6] - now.back().now[6]) == 1) {
                const double exact = 3 * std::log2(touches_[heir[i]].impulse);
                if (std::fabs(exact - now.back().now[6]) < 0.8) q[6] = now.back().now[6];
            }
            put_touch(now.back(), q, true);
        }
        detail::put_number(out_, models_[14 * 8], static_cast<std::int32_t>(fresh.size()));
        quanta last{};
        for (std::size_t t : fresh) {
            stored_touch added;
            added.now = last;
            put_touch(added, next[t], false);
            added.change = {};
            added.size = {};
            last = added.now;
            now.push_back(added);
        }
        note(static_cast<std::int32_t>(now.size()));
        stored_ = std::move(now);
    }

    void put_lines() {
        const auto noting = [&](std::int32_t value) { note(value); };
        std::vector<std::uint32_t> tints;
        for (const body& one : bodies_) tints.push_back(one.tint);
        lines_.put_tints(out_, tints, noting);
        std::vector<std::array<double, 3>> places;
        for (const body& one : bodies_)
            places.push_back(
                {one.now[0] * grid_, one.now[1] * grid_, settings_.dimension == 3 ? one.now[2] * grid_ : 0});
        const auto round = [&](double length) { return rounded(length, line_steps * grid_); };
        lines_.put(out_, drawn_, places, smallest_, round, noting);
    }

    void put_touch(stored_touch& contact, const quanta& next, bool continued) {
        const bool moved = !continued || next != contact.now || contact.change != quanta{};
        if (continued) out_.put(moved, touch_moved_[contact.moved]);
        for (std::size_t i = 0; moved && i < most_channels; ++i) {
            if (settings_.dimension == 2 && (i == 2 || i == 5)) continue;
            if (continued) {
                put(7 + i, next[i] - contact.now[i] - contact.change[i], contact.size[i]);
            } else {
                detail::put_number(out_, models_[(15 + i) * 8], next[i] - contact.now[i]);
            }
            contact.change[i] = i < 3 && continued ? next[i] - contact.now[i] : 0;
        }
        contact.moved = moved;
        contact.now = next;
        for (std::int32_t value : next) note(value);
    }

    scene_settings settings_;
    std::vector<std::pair<std::string, std::string>> facts_;
    std::unordered_map<std::string, int> kinds_;
    std::vector<std::string> kind_texts_, joint_texts_, span_texts_;
    std::vector<body> bodies_;
    std::vector<touch> touches_;
    std::vector<drawn_line> drawn_;
    std::vector<stored_touch> stored_;
    double smallest_ = 1, grid_ = 0;
    int frames_ = 0;
    std::uint32_t check_ = 2166136261u;
    detail::bit_writer out_;
    std::array<detail::number_model, 22 * 8> models_;
    std::array<detail::bit_writer::chance, 2> moved_ = {32768, 32768}, touch_moved_ = {32768, 32768};
    detail::bit_writer::chance alive_ = 32768;
    detail::line_coder lines_{settings_.dimension == 2};
    std::string packed_;
};

}  // namespace samples

// The lines of debug drawing in a recorded run, from frame to frame.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "coder.hpp"
#include "parts.hpp"

namespace samples {

namespace detail {

/// Codes each frame's lines as an edit of the frame before: which went, which came, and how the others moved. Each end
/// is stored from the place of a body, so that what a body takes along costs nearly nothing; and as those of a box
/// share their coordinates, a coordinate goes where an equal one of the same body has gone in the same frame, and
/// opposite to where its negative has.
class line_coder {
public:
    explicit line_coder(bool plane) : axes_(plane ? 2 : 3) {}

    /// Codes a frame of lines; the bodies' places are those that are stored. `round` gives whole steps of a length.
    template <class Round, class Note>
    void put(bit_writer& out, const std::vector<drawn_line>& next, const std::vector<std::array<double, 3>>& places,
             double reach, Round&& round, Note&& note) {
        const std::vector<std::size_t> heir = heirs(next, places, reach, round);
        std::vector<line> now;
        now.reserve(next.size());
        std::size_t done = 0;
        line last;
        bool came = false, went = false;
        const auto put_fresh = [&](std::size_t until) {
            for (; done < until; ++done) {
                out.put(true, comes_[came]);
                came = true;
                now.push_back(fresh(next[done], places, round));
                put_number(out, numbers_[0], now.back().colour);
                for (std::size_t end = 0; end < 2; ++end) {
                    put_number(out, numbers_[1], now.back().body[end] - last.body[end]);
                    for (std::size_t axis = 0; axis < axes_; ++axis) {
                        const std::size_t k = 3 * end + axis;
                        put_number(out, numbers_[2 + axis], now.back().at[k] - last.at[k]);
                    }
                }
                last = now.back();
            }
            out.put(false, comes_[came]);
            came = false;
        };
        for (std::size_t i = 0; i < lines_.size(); ++i) {
            const bool stays = heir[i] < next.size();
            put_fresh(stays ? heir[i] : done);
            out.put(stays, stays_[went]);
            went = !stays;
            if (!stays) continue;
            now.push_back(lines_[i]);
            put_moved(out, now.back(), steps_from(now.back().body, next[heir[i]], places, round), last.foreseen);
            last = now.back();
            ++done;
        }
        put_fresh(next.size());
        lines_ = std::move(now);
        for (auto& axis : gone_) axis.clear();
        note(static_cast<std::int32_t>(lines_.size()));
        for (const line& one : lines_) {
            for (const std::int32_t value : one.body) note(value);
            for (const std::int32_t value : one.at) note(value);
            note(one.colour);
        }
        total_ += lines_.size();
    }

    /// Codes the colour of each body where it changes.
    template <class Note>
    void put_tints(bit_writer& out, const std::vector<std::uint32_t>& tints, Note&& note) {
        tints_.resize(tints.size(), -1);
        for (std::size_t i = 0; i < tints.size(); ++i) {
            const std::int32_t next = number_of(tints[i]);
            out.put(next != tints_[i], tinted_);
            if (next != tints_[i]) put_number(out, numbers_[0], next);
            tints_[i] = next;
            note(next);
        }
    }
    /// All colours, with commas between them.
    [[nodiscard]] std::string palette() const {
        std::string text;
        for (const std::uint32_t colour : colours_) text += (text.empty() ? "" : ",") + std::to_string(colour);
        return text;
    }
    /// How many lines all frames have.
    [[nodiscard]] std::size_t total() const { return total_; }

private:
    /// Steps of both ends from the places of their bodies.
    using steps = std::array<std::int32_t, 6>;
    struct line {
        /// Of which body the recording is told that it is; and from which bodies its ends are stored.
        int owner = -1;
        std::array<std::int32_t, 2> body{};
        steps at{}, change{};
        /// Bits of the last differences from what was expected.
        std::array<std::size_t, 6> size{};
        std::int32_t colour = 0;
        bool foreseen = true;
    };

    std::int32_t number_of(std::uint32_t colour) {
        const auto found = palette_.emplace(colour, static_cast<std::int32_t>(palette_.size()));
        if (found.second) colours_.push_back(colour);
        return found.first->second;
    }
    template <class Round>
    [[nodiscard]] steps steps_from(const std::array<std::int32_t, 2>& body, const drawn_line& drawn,
                                   const std::vector<std::array<double, 3>>& places, Round&& round) const {
        steps result{};
        for (std::size_t end = 0; end < 2; ++end)
            for (std::size_t axis = 0; axis < axes_; ++axis)
                result[3 * end + axis] =
                    round((end == 0 ? drawn.from : drawn.to)[axis] - places[static_cast<std::size_t>(body[end])][axis]);
        return result;
    }
    template <class Round>
    line fresh(const drawn_line& drawn, const std::vector<std::array<double, 3>>& places, Round&& round) {
        line made;
        made.owner = drawn.body;
        for (std::size_t end = 0; end < 2; ++end)
            made.body[end] = drawn.body >= 0 ? drawn.body : nearest(end == 0 ? drawn.from : drawn.to, places);
        made.at = steps_from(made.body, drawn, places, round);
        made.colour = number_of(drawn.colour);
        return made;
    }
    static std::int32_t nearest(const std::array<double, 3>& at, const std::vector<std::array<double, 3>>& places) {
        std::size_t best = 0;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t i = 0; i < places.size(); ++i) {
            const double apart = std::hypot(at[0] - places[i][0], at[1] - places[i][1], at[2] - places[i][2]);
            if (apart < least) least = apart, best = i;
        }
        return static_cast<std::int32_t>(best);
    }

    /// For each line of the frame before the one that it becomes, in order, or the number of lines.
    template <class Round>
    [[nodiscard]] std::vector<std::size_t> heirs(const std::vector<drawn_line>& next,
                                                 const std::vector<std::array<double, 3>>& places, double reach,
                                                 Round&& round) {
        std::vector<std::size_t> heir(lines_.size(), next.size());
        const auto is_alike = [&](const line& a, const drawn_line& b) {
            return a.owner == b.body && colours_[static_cast<std::size_t>(a.colour)] == b.colour;
        };
        if (std::equal(lines_.begin(), lines_.end(), next.begin(), next.end(), is_alike)) {
            for (std::size_t i = 0; i < heir.size(); ++i) heir[i] = i;
            return heir;
        }
        // Where they differ in number: of the next ones the first that is near.
        constexpr std::size_t window = 200;
        const std::int32_t most = round(reach) + 1;
        std::size_t from = 0;
        for (std::size_t t = 0; t < next.size(); ++t)
            for (std::size_t i = from; i < lines_.size() && i < from + window; ++i) {
                if (!is_alike(lines_[i], next[t])) continue;
                const steps at = steps_from(lines_[i].body, next[t], places, round);
                bool near = true;
                for (std::size_t k = 0; k < 6; ++k) near &= std::abs(at[k] - lines_[i].at[k]) <= most;
                if (!near) continue;
                heir[i] = t;
                from = i + 1;
                break;
            }
        return heir;
    }

    /// Where a coordinate is expected, and whether that is where an equal one has gone.
    [[nodiscard]] std::pair<std::int32_t, bool> expected(const line& one, std::size_t k) const {
        const auto& gone = gone_[k % 3];
        if (const auto found = gone.find(one.at[k]); found != gone.end()) return {found->second, true};
        if (const auto found = gone.find(-one.at[k]); found != gone.end()) return {-found->second, true};
        return {one.at[k] + one.change[k], false};
    }
    void put_moved(bit_writer& out, line& one, const steps& next, bool was_foreseen) {
        if (one.body != known_of_)
            for (auto& axis : gone_) axis.clear();
        known_of_ = one.body;
        bool foreseen = true, all_known = true;
        for (std::size_t k = 0; k < 6; ++k) {
            if (k % 3 >= axes_) continue;
            const auto [place, known] = expected(one, k);
            foreseen &= place == next[k];
            all_known &= known;
        }
        out.put(foreseen, foreseen_[(all_known ? 4u : 0u) + (was_foreseen ? 2u : 0u) + (one.foreseen ? 1u : 0u)]);
        for (std::size_t k = 0; k < 6; ++k) {
            if (k % 3 >= axes_) continue;
            if (!foreseen) {
                const auto [place, known] = expected(one, k);
                const std::int32_t rest = next[k] - place;
                auto& size = one.size[k];
                put_number(out, numbers_[known ? 5 : 6 + k / 3 * 8 + size], rest);
                if (!known) size = std::min<std::size_t>(7, std::bit_width(static_cast<unsigned>(std::abs(rest))));
            }
            one.change[k] = next[k] - one.at[k];
            gone_[k % 3][one.at[k]] = next[k];
        }
        one.foreseen = foreseen;
        one.at = next;
    }

    std::size_t axes_;
    std::vector<line> lines_;
    std::vector<std::int32_t> tints_;
    std::unordered_map<std::uint32_t, std::int32_t> palette_;
    std::vector<std::uint32_t> colours_;
    /// Of the bodies of the last line: of each axis where a coordinate of the frame before is now.
    std::array<std::unordered_map<std::int32_t, std::int32_t>, 3> gone_;
    std::array<std::int32_t, 2> known_of_{};
    std::size_t total_ = 0;
    /// Of colours, bodies, the three axes of what comes, coordinates of which an equal one has gone, and of others.
    std::array<number_model, 22> numbers_;
    std::array<bit_writer::chance, 2> comes_ = {32768, 32768}, stays_ = {32768, 32768};
    bit_writer::chance tinted_ = 32768;
    std::array<bit_writer::chance, 8> foreseen_ = {32768, 32768, 32768, 32768, 32768, 32768, 32768, 32768};
};

}  // namespace detail

}  // namespace samples

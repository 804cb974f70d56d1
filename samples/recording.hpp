// Records the motion of bodies, and writes it as one HTML page that plays it without a network.
#pragma once

#include <cstddef>
#include <deque>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "player/scene.hpp"

namespace samples {

/// The page: scenes, and the file that plays them.
class recording {
public:
    explicit recording(std::string title, std::string subtitle = {})
        : title_(std::move(title)), subtitle_(std::move(subtitle)) {}

    /// Starts a run; the reference stays valid as long as the recording.
    recorded_scene& add_scene(scene_settings settings) { return scenes_.emplace_back(std::move(settings)); }

    /// Writes the page, and returns its size in bytes. `player` is the folder with player.html; left empty, it is
    /// the one that the build named with SAMPLES_PLAYER_DIR, else the one beside this header, else samples/player
    /// in the current folder or one above it. Throws std::runtime_error when there is none or the write fails.
    std::size_t write_html(const std::filesystem::path& path, const std::filesystem::path& player = {}) {
        const std::filesystem::path folder = find_player(player);
        std::string page = read(folder / "player.html");
        inline_file(page, folder, "<link rel=\"stylesheet\" href=\"", "<style>\n", "</style>");
        inline_file(page, folder, "<script src=\"", "<script>\n", "</script>");
        const std::size_t heading = page.find("<title>") + 7;
        page.replace(heading, page.find("</title>") - heading, escaped(title_));

        std::string data = "{\"title\":" + detail::quoted(title_) + ",\"subtitle\":" + detail::quoted(subtitle_) +
                           ",\"bytes\":          ,\"scenes\":[";
        const std::size_t bytes_end = data.find(",\"scenes\"");
        for (std::size_t i = 0; i < scenes_.size(); ++i) data += (i ? ",\n" : "\n") + scenes_[i].json();
        data += "]}";
        const std::string slot = "<script id=\"recording\" type=\"application/json\">";
        const std::size_t start = page.find(slot) + slot.size(), end = page.find("</script>", start);
        const std::string total = std::to_string(page.size() - (end - start) + data.size());
        data.replace(bytes_end - total.size(), total.size(), total);
        page.replace(start, end - start, data);

        if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
        std::ofstream file(path, std::ios::binary);
        file << page;
        file.close();
        if (!file) throw std::runtime_error("samples: write_html: cannot write " + path.string());
        return page.size();
    }

private:
    static std::filesystem::path find_player(const std::filesystem::path& given) {
        std::vector<std::filesystem::path> places;
        if (!given.empty()) {
            places.push_back(given);
        } else {
#ifdef SAMPLES_PLAYER_DIR
            places.emplace_back(SAMPLES_PLAYER_DIR);
#endif
            places.push_back(std::filesystem::path(__FILE__).parent_path() / "player");
            for (auto up = std::filesystem::current_path();; up = up.parent_path()) {
                places.push_back(up / "samples" / "player");
                if (up == up.parent_path()) break;
            }
        }
        std::string seen;
        for (const auto& place : places) {
            if (std::filesystem::exists(place / "player.html")) return place;
            seen += " " + place.string();
        }
        throw std::runtime_error("samples: write_html: no player.html in:" + seen);
    }

    static std::string read(const std::filesystem::path& path) {
        std::ifstream file(path, std::ios::binary);
        std::ostringstream text;
        text << file.rdbuf();
        if (!file) throw std::runtime_error("samples: write_html: cannot read " + path.string());
        return text.str();
    }

    /// Replaces every element that names a file of the folder by one that holds its text.
    static void inline_file(std::string& page, const std::filesystem::path& folder, const std::string& opening,
                            const std::string& before, const std::string& after) {
        for (std::size_t at = page.find(opening); at != std::string::npos; at = page.find(opening, at)) {
            const std::size_t name = at + opening.size(), quote = page.find('"', name);
            const std::string text = before + read(folder / page.substr(name, quote - name)) + after;
            std::size_t end = page.find('>', quote) + 1;
            if (after == "</script>") end = page.find(after, end) + after.size();
            page.replace(at, end - at, text);
            at += text.size();
        }
    }

    static std::string escaped(const std::string& text) {
        std::string out;
        for (char c : text) out += c == '<' ? "&lt;" : c == '&' ? "&amp;" : std::string(1, c);
        return out;
    }

    std::string title_, subtitle_;
    std::deque<recorded_scene> scenes_;
};

}  // namespace samples

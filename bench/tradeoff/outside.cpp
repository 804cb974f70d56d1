// What outside.hpp says.
#include "outside.hpp"

#include <fstream>
#include <sstream>

namespace bench {

namespace {

/// Writes JSON; what has been begun has to be ended.
class json {
public:
    explicit json(std::FILE* out) : out_(out) {}

    json& key(const char* name) {
        next();
        std::fprintf(out_, "\"%s\":", name);
        first_ = true;
        return *this;
    }
    void begin(char bracket) {
        next();
        std::fputc(bracket, out_);
        first_ = true;
    }
    void end(char bracket) {
        std::fputc(bracket, out_);
        first_ = false;
    }
    void put(double x) {
        next();
        std::fprintf(out_, "%.17g", x);
    }
    void put(const char* word) {
        next();
        std::fprintf(out_, "\"%s\"", word);
    }
    void put(bool is) {
        next();
        std::fputs(is ? "true" : "false", out_);
    }
    template <std::size_t N>
    void put(const std::array<double, N>& all) {
        begin('[');
        for (const double x : all) put(x);
        end(']');
    }
    /// Calls each(element) in an array.
    template <class All, class Each>
    void list(const char* name, const All& all, Each&& each) {
        key(name).begin('[');
        for (const auto& one : all) each(one);
        end(']');
    }
    template <class Value>
    void field(const char* name, const Value& value) {
        key(name).put(value);
    }

private:
    void next() {
        if (!first_) std::fputs(",", out_);
        first_ = false;
    }
    std::FILE* out_;
    bool first_ = true;
};

const char* name_of(form kind) {
    static const char* const names[] = {"ball", "capsule", "box", "hull", "cylinder", "segment", "chain", "mesh"};
    return names[static_cast<std::size_t>(kind)];
}

void write(json& out, const shape& s) {
    out.begin('{');
    out.field("kind", name_of(s.kind));
    out.field("half", s.half);
    out.field("radius", s.radius);
    out.list("points", s.points, [&](const triple& p) { out.put(p); });
    out.list("triangles", s.triangles, [&](std::uint32_t i) { out.put(static_cast<double>(i)); });
    out.field("at", s.at);
    out.field("rotation", s.rotation);
    out.field("density", s.density);
    out.field("friction", s.friction);
    out.field("restitution", s.restitution);
    out.end('}');
}

void write(json& out, const body& b, int dimension) {
    static const char* const roles[] = {"fixed", "driven", "free"};
    const mass m = mass_of(b, dimension);
    out.begin('{');
    out.field("role", roles[static_cast<std::size_t>(b.kind)]);
    out.field("at", b.at);
    out.field("rotation", b.rotation);
    out.field("velocity", b.velocity);
    out.field("spin", b.spin);
    out.list("shapes", b.shapes, [&](const shape& s) { write(out, s); });
    out.field("born", static_cast<double>(b.born));
    // What follows from the shapes, for engines whose business it is not.
    out.field("mass", m.value);
    out.list("inertia", m.inertia, [&](const triple& row) { out.put(row); });
    out.end('}');
}

void write(json& out, const joint& j) {
    out.begin('{');
    out.field("a", static_cast<double>(j.a));
    out.field("b", static_cast<double>(j.b));
    out.field("point_a", j.point_a);
    out.field("point_b", j.point_b);
    out.field("rigid", j.rigid);
    out.field("friction", j.friction);
    out.field("lower", j.lower);
    out.field("upper", j.upper);
    out.end('}');
}

}  // namespace

void write_json(std::FILE* to, const scene& s) {
    json out(to);
    out.begin('{');
    out.field("name", s.name.c_str());
    out.field("dimension", static_cast<double>(s.dimension));
    out.field("gravity", s.gravity);
    out.field("interval", film::interval);
    out.field("frames", static_cast<double>(s.steps));
    out.field("sleeps", s.sleeps);
    out.list("bodies", s.bodies, [&](const body& b) { write(out, b, s.dimension); });
    out.list("joints", s.joints, [&](const joint& j) { write(out, j); });
    out.list("swings", s.swings, [&](const swing& w) {
        out.begin('{');
        out.field("body", static_cast<double>(w.body));
        out.field("reach", w.reach);
        out.field("rate", w.rate);
        out.end('}');
    });
    out.end('}');
    std::fputc('\n', to);
}

std::vector<contestant> listed(const std::string& file) {
    std::vector<contestant> all;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string adapter;
        contestant who;
        if (words >> adapter >> who.name >> who.dimension >> who.has_joints &&
            std::getline(words >> std::ws, who.settings))
            all.push_back(who);
    }
    return all;
}

bool read(std::FILE* in, const scene& s, outside_run& into) {
    const auto line = [&] {
        std::string text;
        for (int c; (c = std::fgetc(in)) != EOF && c != '\n';) text += static_cast<char>(c);
        return text;
    };
    const std::string gravity = line(), times = line(), sizes = line();
    std::size_t frames = 0, bodies = 0;
    triple& g = into.gravity;
    if (std::sscanf(gravity.c_str(), "gravity %lf %lf %lf", &g[0], &g[1], &g[2]) != 3) return false;
    std::istringstream words(times);
    std::string word;
    words >> word;
    for (double x; words >> x;) into.seconds.push_back(x);
    if (word != "seconds" || into.seconds.empty()) return false;
    if (std::sscanf(sizes.c_str(), "frames %zu bodies %zu", &frames, &bodies) != 2) return false;
    if (frames != static_cast<std::size_t>(s.steps) + 1 || bodies != s.bodies.size()) return false;
    into.seen.frames.assign(frames, std::vector<state>(bodies));
    for (auto& frame : into.seen.frames)
        for (state& b : frame) {
            double x[14];
            if (std::fread(x, sizeof x, 1, in) != 1) return false;
            b = {{x[0], x[1], x[2]}, {x[3], x[4], x[5], x[6]}, {x[7], x[8], x[9]}, {x[10], x[11], x[12]}, x[13]};
        }
    return std::fgetc(in) == EOF;
}

}  // namespace bench

// An engine that plays a scene.
#pragma once

#include "../timing.hpp"
#include "engine.hpp"

namespace bench {

/// An engine in the middle of a scene.
class run {
public:
    run(const scene& s, const contestant& c) : scene_(s), engine_(c.make(s.dimension)) {
        engine_->begin(s);
        born();
    }
    void step() {
        for (const swing& w : scene_.swings) engine_->drive(w.body, {w.speed(done_ * scene_.dt, scene_.dt), 0, 0}, {});
        const stopwatch clock;
        engine_->step(scene_.dt);
        last_ = clock.ns() / 1e6;
        ++done_;
        born();
    }
    [[nodiscard]] double last_ms() const { return last_; }
    [[nodiscard]] const engine& it() const { return *engine_; }

private:
    void born() {
        while (next_ < scene_.bodies.size() && scene_.bodies[next_].born <= done_) engine_->add(scene_.bodies[next_++]);
        const auto there = [&](int body) { return static_cast<std::size_t>(body) < next_; };
        for (; joined_ < scene_.joints.size(); ++joined_) {
            const joint& j = scene_.joints[joined_];
            if (!there(j.a) || !there(j.b)) break;
            engine_->join(j);
        }
    }
    const scene& scene_;
    std::unique_ptr<engine> engine_;
    std::size_t next_ = 0, joined_ = 0;
    int done_ = 0;
    double last_ = 0;
};

}  // namespace bench

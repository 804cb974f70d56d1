// Executors: who does the parts of a step's work, on one thread or on several.
#pragma once

#include <concepts>

#include "physics/base/buffer.hpp"
#include "physics/base/probe.hpp"

PHYSICS_HPP_BEGIN

/// Work in parts, as executors get it: to be called once with the number of each part, and with that of the worker who
/// does it. It throws nothing, and may be called from any thread.
class work {
public:
    template <class F>
    work(F& f, unsigned char* done, std::uint32_t parts, std::uint32_t workers)
        : f_(&f),
          call_([](void* of, std::uint32_t part, std::uint32_t worker) { (*static_cast<F*>(of))(part, worker); }),
          done_(done),
          parts_(parts),
          workers_(workers) {}

    void operator()(std::uint32_t part, std::uint32_t worker) const {
        if (!(part < parts_ && worker < workers_)) return;
        const float_control_scope control;
        call_(f_, part, worker);
        done_[part] = 1;
    }

private:
    void* f_;
    void (*call_)(void*, std::uint32_t, std::uint32_t);
    unsigned char* done_;
    std::uint32_t parts_, workers_;
};

/// Who may be handed to world::step. workers(): how many can be at work at a time, at least 1, and the same for a whole
/// step. run(parts, what): calls what(part, worker) once for every part below `parts`, in any order, with numbers of
/// workers below workers(), never two calls with the same one at a time, and returns when all are done. Results do not
/// depend on any of it.
template <class E>
concept executor = requires(E& e, const work& what) {
    { e.workers() } -> std::convertible_to<std::uint32_t>;
    e.run(std::uint32_t{}, what);
};

namespace detail {

/// An executor without its type, or nobody but the caller.
class crew {
public:
    crew() = default;
    template <executor E>
    crew(E& of, buffer<unsigned char>& done)
        : executor_(&of),
          run_([](void* e, std::uint32_t parts, const work& what) { static_cast<E*>(e)->run(parts, what); }),
          done_(&done),
          workers_(static_cast<std::uint32_t>(of.workers())) {}

    [[nodiscard]] std::uint32_t workers() const { return workers_; }
    [[nodiscard]] bool is_alone() const { return workers_ == 1; }
    /// Whether all parts have been done so far.
    [[nodiscard]] bool is_sound() const { return sound_; }

    /// Calls f(part, worker) for all parts. What the executor leaves out is done here, so that no stage finds anything
    /// half made before the step is refused.
    template <class F>
    void each(std::uint32_t parts, F&& f) {
        if (is_alone() || parts < 2) {
            for (std::uint32_t k = 0; k < parts; ++k) f(k, 0);
            return;
        }
        done_->clear();
        done_->resize(parts);
        run_(executor_, parts, work(f, done_->begin(), parts, workers_));
        for (std::uint32_t k = 0; k < parts; ++k) {
            if ((*done_)[k] != 0) continue;
            sound_ = false;
            f(k, 0);
        }
    }
    /// Calls f(first, end, worker) for all of `count` things, in parts of `share`.
    template <class F>
    void each_part(std::uint32_t count, std::uint32_t share, F&& f) {
        each(count / share + (count % share > 0), [&](std::uint32_t part, std::uint32_t worker) {
            const std::uint32_t first = part * share;
            f(first, count - first < share ? count : first + share, worker);
        });
    }

private:
    void* executor_ = nullptr;
    void (*run_)(void*, std::uint32_t, const work&) = nullptr;
    buffer<unsigned char>* done_ = nullptr;
    std::uint32_t workers_ = 1;
    bool sound_ = true;
};

/// One T for each worker, which outlive a step so that their memory does. A copy starts with fresh ones.
template <class T>
class per_worker {
public:
    per_worker() = default;
    per_worker(const per_worker&) {}
    per_worker(per_worker&& other) noexcept { swap(other); }
    per_worker& operator=(const per_worker&) { return *this; }
    per_worker& operator=(per_worker&& other) noexcept {
        per_worker taken(std::move(other));
        swap(taken);
        return *this;
    }
    ~per_worker() { delete[] more_; }

    T& operator[](std::uint32_t worker) { return worker == 0 ? first_ : more_[worker - 1]; }
    void prepare(std::uint32_t workers) {
        if (workers <= count_) return;
        T* const more = new T[workers - 1];
        for (std::uint32_t k = 1; k < count_; ++k) more[k - 1] = std::move(more_[k - 1]);
        delete[] more_;
        more_ = more;
        count_ = workers;
    }

private:
    void swap(per_worker& other) noexcept {
        std::swap(first_, other.first_);
        std::swap(more_, other.more_);
        std::swap(count_, other.count_);
    }

    T first_;
    T* more_ = nullptr;
    std::uint32_t count_ = 1;
};

}  // namespace detail

PHYSICS_HPP_END

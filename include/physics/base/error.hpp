// What happens with bad input: a message that names the function, the field and the value.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include "physics/base/config.hpp"

PHYSICS_HPP_BEGIN

/// A refused call: which function, which field, which value, and what was expected. The world is as it
/// was before the call. Thrown where exceptions are on, otherwise handed to the error handler.
class error : public std::exception {
public:
    error(const char* function, const char* field, const char* value, const char* rule) noexcept {
        std::snprintf(text_, sizeof text_, "physics: %s: %s is %s; %s", function, field, value, rule);
    }
    /// The whole sentence, for example `physics: create_body: position.x is nan; it must be finite`.
    [[nodiscard]] const char* what() const noexcept override { return text_; }

private:
    char text_[256];
};

/// A call that was refused since there is no memory for it.
class out_of_memory : public error {
public:
    using error::error;
};

/// Called with every refused call in builds without exceptions.
using error_handler = void (*)(const error&);

namespace detail {
[[noreturn]] inline void print_and_abort(const error& failure) {
    std::fprintf(stderr, "%s\n", failure.what());
    std::abort();
}
inline error_handler& current_error_handler() noexcept {
    static error_handler handler = print_and_abort;
    return handler;
}
}  // namespace detail

/// Sets what builds without exceptions (-fno-exceptions) do with a refused call, and returns the former
/// handler; nullptr restores the default, which prints and aborts. If the handler returns, the refused
/// function returns too, with a null handle or a zero, and nothing has changed. Not thread-safe: set it
/// once, at the start. Builds with exceptions throw instead and never call it.
inline error_handler set_error_handler(error_handler handler) noexcept {
    error_handler former = detail::current_error_handler();
    detail::current_error_handler() = handler ? handler : detail::print_and_abort;
    return former;
}

namespace detail {

/// Throws the error, or calls the handler and returns false where exceptions are off.
PHYSICS_HPP_COLD inline bool refuse(const char* function, const char* field, const char* value, const char* rule) {
#if PHYSICS_HPP_EXCEPTIONS
    throw error(function, field, value, rule);
#else
    current_error_handler()(error(function, field, value, rule));
    return false;
#endif
}

PHYSICS_HPP_COLD inline bool refuse(const char* function, const char* field, double value, const char* rule) {
    char text[40];
    std::snprintf(text, sizeof text, "%.9g", value);
    // Some systems write nan with a sign.
    return refuse(function, field, value != value ? "nan" : text, rule);
}

/// There is no memory for so many bytes, or for some if that is 0: throws out_of_memory, or calls the handler and
/// aborts where exceptions are off, as nothing can go on without it.
[[noreturn]] PHYSICS_HPP_COLD inline void refuse_memory(const char* function, double bytes) {
    char text[40] = "too little";
    if (bytes > 0) std::snprintf(text, sizeof text, "%.9g", bytes);
    const char* rule = "the bytes are not available";
#if PHYSICS_HPP_EXCEPTIONS
    throw out_of_memory(function, "memory", text, rule);
#else
    current_error_handler()(out_of_memory(function, "memory", text, rule));
    std::abort();
#endif
}
/// Calls f, which may fail for want of memory alone: says whether it has not.
template <class F>
bool run_if_memory_lasts(F&& f) {
#if PHYSICS_HPP_EXCEPTIONS
    try {
        f();
    } catch (const out_of_memory&) {
        return false;
    } catch (const std::bad_alloc&) {
        return false;
    }
#else
    f();
#endif
    return true;
}

/// The same for a component of a field, such as ".x" of "position".
PHYSICS_HPP_COLD inline bool refuse(const char* function, const char* field, const char* component, double value,
                                    const char* rule) {
    char name[80];
    std::snprintf(name, sizeof name, "%s%s", field, component);
    return refuse(function, name, value, rule);
}

}  // namespace detail

/// For the checks of your own shapes and policies: refuse(function, field, value, rule) throws the error, or calls the
/// handler and returns false; the value is text or a number.
using detail::refuse;

PHYSICS_HPP_END

// Packs whole numbers into few bytes, and bytes into text: what a recording is stored with.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace samples {

namespace detail {

/// A binary arithmetic coder: each yes or no costs -log2 of the chance that its model gave it.
class bit_writer {
public:
    using chance = std::uint16_t;

    void put(bool bit, chance& yes) {
        narrow(bit, yes);
        yes = static_cast<chance>(bit ? yes + ((65536 - yes) >> 5) : yes - (yes >> 5));
    }
    void put_even(bool bit) { narrow(bit, 32768); }
    /// Closes the stream; nothing may be put after it.
    const std::string& finish() {
        for (int byte = 0; byte < 4; ++byte) emit(low_ >> (24 - 8 * byte));
        return bytes_;
    }

private:
    void narrow(bool bit, std::uint32_t yes) {
        const std::uint32_t width = high_ - low_;
        const std::uint32_t middle = low_ + (width >> 16) * yes + (((width & 0xffffu) * yes) >> 16);
        (bit ? high_ : low_) = bit ? middle : middle + 1;
        while (((low_ ^ high_) & 0xff000000u) == 0) {
            emit(high_ >> 24);
            low_ <<= 8;
            high_ = high_ << 8 | 255u;
        }
    }
    void emit(std::uint32_t byte) { bytes_.push_back(static_cast<char>(byte & 255u)); }

    std::string bytes_;
    std::uint32_t low_ = 0, high_ = 0xffffffffu;
};

/// The chances of one kind of whole number: zero or not, its sign, its length in bits, its leading bit.
struct number_model {
    std::array<bit_writer::chance, 66> chances;
    number_model() { chances.fill(32768); }
};

inline void put_number(bit_writer& out, number_model& model, std::int32_t value) {
    out.put(value == 0, model.chances[0]);
    if (value == 0) return;
    out.put(value < 0, model.chances[1]);
    const auto size = static_cast<std::uint32_t>(value < 0 ? -value : value);
    const int length = static_cast<int>(std::bit_width(size)) - 1;
    for (int i = 0; i < length; ++i) out.put(true, model.chances[static_cast<std::size_t>(2 + i)]);
    out.put(false, model.chances[static_cast<std::size_t>(2 + length)]);
    for (int i = length - 1; i >= 0; --i) {
        const bool bit = (size >> i & 1u) != 0;
        if (i == length - 1) out.put(bit, model.chances[static_cast<std::size_t>(34 + length)]);
        else out.put_even(bit);
    }
}

inline std::string base64(std::string_view bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t group = 0;
        for (std::size_t k = i; k < i + 3; ++k)
            group = group << 8 | (k < bytes.size() ? static_cast<unsigned char>(bytes[k]) : 0u);
        for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : digits[group >> (18 - 6 * k) & 63u];
    }
    return text;
}

/// A JSON string that is also safe inside a script element.
inline std::string quoted(std::string_view text) {
    std::string out = "\"";
    for (char c : text) {
        if (static_cast<unsigned char>(c) < 32 || c == '<' || c == '"' || c == '\\') {
            char code[8];
            std::snprintf(code, sizeof code, "\\u%04x", static_cast<unsigned>(static_cast<unsigned char>(c)));
            out += code;
        } else {
            out += c;
        }
    }
    return out + '"';
}

inline std::string number(double value, int digits = 9) {
    char text[40];
    std::snprintf(text, sizeof text, "%.*g", digits, value);
    return text;
}

}  // namespace detail

}  // namespace samples

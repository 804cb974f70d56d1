// Reads the stream of a recording; written from its description, sharing no code with what writes it.
#pragma once

#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <utility>

namespace {

/// Reads what samples::detail::bit_writer wrote.
class bit_reader {
public:
    explicit bit_reader(std::string bytes) : bytes_(std::move(bytes)) {
        for (int i = 0; i < 4; ++i) code_ = code_ << 8 | next();
    }
    bool get(std::uint16_t& yes) {
        const bool bit = even(yes);
        yes = static_cast<std::uint16_t>(bit ? yes + (65536 - yes) / 32 : yes - yes / 32);
        return bit;
    }
    bool even(std::uint32_t yes = 32768) {
        const std::uint64_t width = high_ - low_;
        const auto middle = static_cast<std::uint32_t>(low_ + (width * yes >> 16));
        const bool bit = code_ <= middle;
        if (bit) high_ = middle;
        else low_ = middle + 1;
        while (low_ >> 24 == high_ >> 24) {
            low_ <<= 8;
            high_ = high_ << 8 | 255u;
            code_ = code_ << 8 | next();
        }
        return bit;
    }
    int number(std::uint16_t* model) {
        if (get(model[0])) return 0;
        const bool negative = get(model[1]);
        int length = 0, size = 1;
        while (get(model[2 + length])) ++length;
        for (int i = length; i > 0; --i) size = 2 * size + (i == length ? get(model[34 + length]) : even());
        return negative ? -size : size;
    }

private:
    std::uint32_t next() { return at_ < bytes_.size() ? static_cast<unsigned char>(bytes_[at_++]) : 0u; }
    std::string bytes_;
    std::size_t at_ = 0;
    std::uint32_t low_ = 0, high_ = 0xffffffffu, code_ = 0;
};

double field(const std::string& json, const std::string& name) {
    const std::size_t at = json.find("\"" + name + "\":");
    REQUIRE(at != std::string::npos);
    return std::stod(json.substr(at + name.size() + 3));
}

std::string unpacked(const std::string& json) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t from = json.find("\"data\":\"") + 8;
    std::string bytes;
    unsigned group = 0;
    int bits = 0;
    for (std::size_t i = from; json[i] != '"' && json[i] != '='; ++i) {
        group = group << 6 | static_cast<unsigned>(digits.find(json[i]));
        if ((bits += 6) >= 8) bytes += static_cast<char>(group >> (bits -= 8) & 255u);
    }
    return bytes;
}

}  // namespace

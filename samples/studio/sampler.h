// Sample points of the path tracer: Owen-scrambled Sobol points in pairs of dimensions.
//
// Source: I. Sobol's first two dimensions, a (0,2)-sequence; B. Burley, "Practical Hash-based Owen
// Scrambling" (JCGT 2020) for nested uniform scrambling by a hash on reversed bits and for padding many
// dimensions with independently shuffled pairs; the hash is N. Vegdahl's variant of Laine and Karras's.
// Every (seed, stream, pair) has its own shuffle and scrambles, so pixels, halves and path vertices are
// uncorrelated, while the first 2^k samples of one pair stay a (0,k,2)-net.
#pragma once

#include <cstdint>

#include <glm/glm.hpp>

namespace studio {

inline std::uint64_t mixBits(std::uint64_t x) {  // finalizer of D. Stafford's "Mix13"
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

inline std::uint32_t reverseBits(std::uint32_t x) {
    x = ((x >> 1) & 0x55555555u) | ((x & 0x55555555u) << 1);
    x = ((x >> 2) & 0x33333333u) | ((x & 0x33333333u) << 2);
    x = ((x >> 4) & 0x0f0f0f0fu) | ((x & 0x0f0f0f0fu) << 4);
    return __builtin_bswap32(x);
}

// Permutes so that each bit depends only on itself and lower ones: on reversed bits, Owen scrambling.
inline std::uint32_t permuteUpwards(std::uint32_t x, std::uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

// Bits of the second Sobol coordinate, least significant digit first. Its direction numbers, read
// so, are the polynomials (1+x)^j over GF(2); the sum over the index's bits is therefore the index's
// polynomial at 1+x, which Taylor shifts of the upper half onto the lower, 16 to 1 wide, evaluate.
inline std::uint32_t sobolSecondReversed(std::uint32_t index) {
    index ^= index >> 16;
    index ^= (index & 0xff00ff00u) >> 8;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xaaaaaaaau) >> 1;
    return index;
}

// The points of one sample of one stream (a pixel's half), drawn pair after pair.
class Sampler {
public:
    Sampler(std::uint64_t seed, std::uint64_t stream, std::uint32_t index)
        : base_(mixBits(seed + mixBits(stream))), reversedIndex_(reverseBits(index)) {}

    glm::dvec2 nextFine() {  // in [0,1)^2, of 32 bits: enough to choose with and then use what is left
        const std::uint64_t a = mixBits(base_ + 2 * pair_), b = mixBits(base_ + 2 * pair_ + 1);
        ++pair_;
        const std::uint32_t index = reverseBits(permuteUpwards(reversedIndex_, std::uint32_t(a)));
        const std::uint32_t u = reverseBits(permuteUpwards(index, std::uint32_t(a >> 32)));
        const std::uint32_t v =
            reverseBits(permuteUpwards(sobolSecondReversed(index), std::uint32_t(b)));
        constexpr double kScale = 1.0 / 4294967296.0;
        return glm::dvec2(double(u) * kScale, double(v) * kScale);
    }

    glm::vec2 next() {  // in [0,1)^2; cut to 24 bits, which never round up to 1
        const glm::dvec2 point = glm::floor(nextFine() * 16777216.0);
        return glm::vec2(point) * (1.0f / 16777216.0f);
    }

private:
    std::uint64_t base_;
    std::uint64_t pair_ = 0;
    std::uint32_t reversedIndex_;
};

// Direction about unit `normal` with density cos / pi per solid angle, by the concentric map (P. Shirley
// and K. Chiu 1997), which keeps neighbouring points neighbours.
glm::vec3 sampleCosine(const glm::vec3& normal, glm::vec2 point);

}  // namespace studio

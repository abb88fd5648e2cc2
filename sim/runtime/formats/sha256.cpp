// SHA-256 by OpenSSL, or of two texts at a time by the processor's own instructions.
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/formats/sha256.h"

#include <openssl/sha.h>

#include <algorithm>

#include "shared/base/hex_text.hpp"

#if defined(__x86_64__)
#include <cpuid.h>
#include <immintrin.h>
#endif

namespace kaz::sim {
namespace {

#if defined(__x86_64__)

// The compilers' names for what a processor has do not all include these.
bool has_sha_instructions() {
  unsigned a = 0, b = 0, c = 0, d = 0;
  constexpr unsigned kSha = 1U << 29;  // leaf 7, EBX
  return __builtin_cpu_supports("sse4.1") != 0 && __get_cpuid_count(7, 0, &a, &b, &c, &d) != 0 &&
         (b & kSha) != 0;
}

constexpr std::size_t kBlock = 64;  // bytes

// Constants of the rounds and the initial state (FIPS 180-4, 4.2.2 and 5.3.3).
alignas(16) constexpr std::array<std::uint32_t, 64> kRounds{
    0x428A2F98, 0x71374491, 0xB5C0FBCF, 0xE9B5DBA5, 0x3956C25B, 0x59F111F1, 0x923F82A4, 0xAB1C5ED5,
    0xD807AA98, 0x12835B01, 0x243185BE, 0x550C7DC3, 0x72BE5D74, 0x80DEB1FE, 0x9BDC06A7, 0xC19BF174,
    0xE49B69C1, 0xEFBE4786, 0x0FC19DC6, 0x240CA1CC, 0x2DE92C6F, 0x4A7484AA, 0x5CB0A9DC, 0x76F988DA,
    0x983E5152, 0xA831C66D, 0xB00327C8, 0xBF597FC7, 0xC6E00BF3, 0xD5A79147, 0x06CA6351, 0x14292967,
    0x27B70A85, 0x2E1B2138, 0x4D2C6DFC, 0x53380D13, 0x650A7354, 0x766A0ABB, 0x81C2C92E, 0x92722C85,
    0xA2BFE8A1, 0xA81A664B, 0xC24B8B70, 0xC76C51A3, 0xD192E819, 0xD6990624, 0xF40E3585, 0x106AA070,
    0x19A4C116, 0x1E376C08, 0x2748774C, 0x34B0BCB5, 0x391C0CB3, 0x4ED8AA4A, 0x5B9CCA4F, 0x682E6FF3,
    0x748F82EE, 0x78A5636F, 0x84C87814, 0x8CC70208, 0x90BEFFFA, 0xA4506CEB, 0xBEF9A3F7, 0xC67178F2};
constexpr std::uint32_t kA = 0x6A09E667, kB = 0xBB67AE85, kC = 0x3C6EF372, kD = 0xA54FF53A;
constexpr std::uint32_t kE = 0x510E527F, kF = 0x9B05688C, kG = 0x1F83D9AB, kH = 0x5BE0CD19;

// Words a, b, e, f and c, d, g, h, each the first in the highest lane, as the instructions have them.
struct State {
  __m128i abef, cdgh;
};

// Blocks of two texts in turn: an instruction for two rounds takes four cycles, but another may begin after
// two.
[[gnu::target("sha,sse4.1")]] void take_blocks(std::array<State, 2>& states,
                                               const std::array<const std::uint8_t*, 2>& texts,
                                               std::size_t blocks) {
  const __m128i big_endian = _mm_set_epi64x(0x0C0D0E0F08090A0B, 0x0405060700010203);
  for (std::size_t n = 0; n < blocks; ++n) {
    __m128i words[2][4];  // the last sixteen of the message schedule
    std::array<State, 2> now = states;
#pragma GCC unroll 16
    for (std::size_t i = 0; i < 16; ++i) {  // four rounds each
#pragma GCC unroll 2
      for (std::size_t k = 0; k < 2; ++k) {
        __m128i(&w)[4] = words[k];
        __m128i& next = w[i % 4];
        const __m128i last = w[(i + 3) % 4];
        if (i < 4) {
          next = _mm_shuffle_epi8(
              _mm_loadu_si128(reinterpret_cast<const __m128i*>(texts[k] + kBlock * n + 16 * i)),
              big_endian);
        } else {
          next = _mm_sha256msg2_epu32(_mm_add_epi32(_mm_sha256msg1_epu32(next, w[(i + 1) % 4]),
                                                    _mm_alignr_epi8(last, w[(i + 2) % 4], 4)),
                                      last);
        }
        const __m128i sum =
            _mm_add_epi32(next, _mm_load_si128(reinterpret_cast<const __m128i*>(&kRounds[4 * i])));
        now[k].cdgh = _mm_sha256rnds2_epu32(now[k].cdgh, now[k].abef, sum);
        now[k].abef = _mm_sha256rnds2_epu32(now[k].abef, now[k].cdgh, _mm_shuffle_epi32(sum, 0x0E));
      }
    }
    for (std::size_t k = 0; k < 2; ++k) {
      states[k].abef = _mm_add_epi32(states[k].abef, now[k].abef);
      states[k].cdgh = _mm_add_epi32(states[k].cdgh, now[k].cdgh);
    }
  }
}

std::array<std::uint8_t, 32> digest_of(const State& state) {
  std::array<std::uint32_t, 4> abef{}, cdgh{};
  _mm_storeu_si128(reinterpret_cast<__m128i*>(abef.data()), state.abef);
  _mm_storeu_si128(reinterpret_cast<__m128i*>(cdgh.data()), state.cdgh);
  std::array<std::uint8_t, 32> digest{};
  std::size_t at = 0;
  for (const std::uint32_t word :
       {abef[3], abef[2], cdgh[3], cdgh[2], abef[1], abef[0], cdgh[1], cdgh[0]}) {
    for (int shift = 24; shift >= 0; shift -= 8)
      digest[at++] = static_cast<std::uint8_t>(word >> shift);
  }
  return digest;
}

// Texts of one length.
std::array<std::string, 2> by_instructions(std::span<const std::uint8_t> a,
                                           std::span<const std::uint8_t> b) {
  const State initial{_mm_set_epi32(static_cast<int>(kA), static_cast<int>(kB),
                                    static_cast<int>(kE), static_cast<int>(kF)),
                      _mm_set_epi32(static_cast<int>(kC), static_cast<int>(kD),
                                    static_cast<int>(kG), static_cast<int>(kH))};
  std::array<State, 2> states{initial, initial};
  const std::size_t whole = a.size() / kBlock;
  take_blocks(states, {a.data(), b.data()}, whole);
  // The rest, a bit that is one, zeros, and the length in bits in the last eight bytes.
  const std::size_t rest = a.size() % kBlock, blocks = rest + 9 <= kBlock ? 1 : 2;
  std::array<std::array<std::uint8_t, 2 * kBlock>, 2> ends{};
  for (std::size_t k = 0; k < 2; ++k) {
    std::ranges::copy((k == 0 ? a : b).last(rest), ends[k].begin());
    ends[k][rest] = 0x80;
    for (std::size_t i = 0; i < 8; ++i)
      ends[k][blocks * kBlock - 1 - i] =
          static_cast<std::uint8_t>(std::uint64_t{a.size()} * 8 >> (8 * i));
  }
  take_blocks(states, {ends[0].data(), ends[1].data()}, blocks);
  return {hex_text(digest_of(states[0])), hex_text(digest_of(states[1]))};
}

#endif

}  // namespace

std::string sha256_hex(std::span<const std::uint8_t> bytes) {
  std::array<std::uint8_t, SHA256_DIGEST_LENGTH> digest{};
  SHA256(bytes.data(), bytes.size(), digest.data());
  return hex_text(digest);
}

std::array<std::string, 2> sha256_hex_pair(std::span<const std::uint8_t> a,
                                           std::span<const std::uint8_t> b) {
#if defined(__x86_64__)
  static const bool instructions = has_sha_instructions();
  if (instructions && a.size() == b.size()) return by_instructions(a, b);
#endif
  return {sha256_hex(a), sha256_hex(b)};
}

}  // namespace kaz::sim

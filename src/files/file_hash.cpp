// SPDX-License-Identifier: GPL-3.0-or-later
#include "files/file_hash.hpp"

#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>

#include <array>
#include <new>

#include "files/input_registry.hpp"

namespace tubefoot {
namespace {

EVP_MD_CTX* new_state() {
  // The settings of OpenSSL are a file of the machine. tubefoot reads only files that the scene names.
  OPENSSL_init_crypto(OPENSSL_INIT_NO_LOAD_CONFIG, nullptr);
  EVP_MD_CTX* const state = EVP_MD_CTX_new();
  if (state == nullptr) throw std::bad_alloc();
  return state;
}

void require(int done) {
  if (done != 1) throw std::bad_alloc();  // these functions fail only for lack of memory
}

}  // namespace

Sha256::Sha256() : state_(new_state()) { require(EVP_DigestInit_ex(state_, EVP_sha256(), nullptr)); }

Sha256::~Sha256() { EVP_MD_CTX_free(state_); }

void Sha256::update(std::string_view bytes) { require(EVP_DigestUpdate(state_, bytes.data(), bytes.size())); }

std::string Sha256::hex_digest() const {
  const Sha256 last;
  require(EVP_MD_CTX_copy_ex(last.state_, state_));
  std::array<unsigned char, 32> digest{};
  require(EVP_DigestFinal_ex(last.state_, digest.data(), nullptr));
  std::string text;
  for (const unsigned char byte : digest) text += fmt::format("{:02x}", byte);
  return text;
}

std::string sha256_of(const std::filesystem::path& file) {
  Sha256 hash;
  InputFile(file).for_each_piece([&](std::string_view piece) { hash.update(piece); });
  return hash.hex_digest();
}

}  // namespace tubefoot

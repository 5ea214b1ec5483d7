/// \file
/// The text of the option `--seed`.
#pragma once
namespace underbrush {
/// The help of `--seed`.
inline constexpr const char* kSeedHelp = "Seed of all random numbers";
}  // namespace underbrush

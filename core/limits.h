#pragma once

namespace hydroscope {

/// Parameters that a balance may have, fitted at once. Checked where a machine is read;
/// everything that follows holds as many.
inline constexpr int kMaxParameters = 32;
/// Physical parameters that may be derived from those beyond them.
inline constexpr int kMaxDerived = 32;
/// States of a machine that is described by states.
inline constexpr int kMaxStates = 16;
/// Constants of one effect that are found from the data.
inline constexpr int kMaxShape = 2;
/// Conditions that are stored with every stroke of a machine.
inline constexpr int kMaxConditions = 6;

}  // namespace hydroscope

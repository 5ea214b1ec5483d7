#pragma once
// A header that does not include what it uses: rules.headers.alive sees it fail.
inline std::vector<int> nothing() { return {}; }

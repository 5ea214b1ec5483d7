#pragma once
// A private header that needs another before it: rules.headers.inl_alive sees it fail.
inline std::vector<int> nothing() { return {}; }

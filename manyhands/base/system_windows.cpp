// manyhands/base/system.h for Windows.
#define NOMINMAX
#define WIN32_LEAN_AND_MEAN
#include <windows.h>

#include <algorithm>
#include <new>
#include <string>
#include <system_error>
#include <utility>

#include "manyhands/base/system.h"

namespace manyhands::system {

namespace {

[[noreturn]] void fail() { throw std::system_error(static_cast<int>(GetLastError()), std::system_category()); }

HANDLE handle_of(std::intptr_t number) { return reinterpret_cast<HANDLE>(number); }

std::intptr_t create(const std::filesystem::path& path, DWORD access, DWORD flags) {
  const HANDLE file = CreateFileW(path.c_str(), access, 0, nullptr, CREATE_NEW, flags, nullptr);
  if (file == INVALID_HANDLE_VALUE) fail();
  return reinterpret_cast<std::intptr_t>(file);
}

/// Closes what it holds.
struct Closing {
  HANDLE handle;
  ~Closing() { CloseHandle(handle); }
};

/// A file that nobody else has: Windows makes no name of its own accord without making the file, too.
std::filesystem::path free_name(const std::filesystem::path& folder) {
  static long long count = 0;
  LARGE_INTEGER ticks;
  QueryPerformanceCounter(&ticks);
  return folder / ("manyhands." + std::to_string(process_id()) + "." + std::to_string(ticks.QuadPart + count++));
}

}  // namespace

int process_id() { return static_cast<int>(GetCurrentProcessId()); }

NewFile::NewFile(const std::filesystem::path& path) : handle_(create(path, GENERIC_WRITE, FILE_ATTRIBUTE_NORMAL)) {}

NewFile::~NewFile() {
  if (handle_ != 0) CloseHandle(handle_of(handle_));
}

void NewFile::write(std::span<const std::byte> bytes) {
  constexpr std::size_t kMost = 1u << 30;
  while (!bytes.empty()) {
    DWORD written = 0;
    const auto wanted = static_cast<DWORD>(std::min(bytes.size(), kMost));
    if (!WriteFile(handle_of(handle_), bytes.data(), wanted, &written, nullptr)) fail();
    bytes = bytes.subspan(written);
  }
}

void NewFile::close() {
  if (!FlushFileBuffers(handle_of(handle_))) fail();
  if (!CloseHandle(handle_of(std::exchange(handle_, 0)))) fail();
}

void* map_memory(std::size_t size, const std::filesystem::path& folder) {
  void* bytes = nullptr;
  if (folder.empty()) {
    bytes = VirtualAlloc(nullptr, size, MEM_RESERVE | MEM_COMMIT, PAGE_READWRITE);
  } else {
    // The view holds both, and the file goes with its last holder.
    constexpr DWORD kAccess = GENERIC_READ | GENERIC_WRITE | DELETE;
    const Closing file{handle_of(create(free_name(folder), kAccess, FILE_FLAG_DELETE_ON_CLOSE))};
    const auto high = static_cast<DWORD>(static_cast<std::uint64_t>(size) >> 32), low = static_cast<DWORD>(size);
    const HANDLE section = CreateFileMappingW(file.handle, nullptr, PAGE_READWRITE, high, low, nullptr);
    if (section == nullptr) fail();
    const Closing closing{section};
    bytes = MapViewOfFile(section, FILE_MAP_ALL_ACCESS, 0, 0, size);
  }
  if (bytes == nullptr) throw std::bad_alloc();
  return bytes;
}

/// Memory and views go each by a function of its own: the one refuses what is the other's.
void unmap_memory(void* bytes, std::size_t) {
  if (!UnmapViewOfFile(bytes)) VirtualFree(bytes, 0, MEM_RELEASE);
}

}  // namespace manyhands::system

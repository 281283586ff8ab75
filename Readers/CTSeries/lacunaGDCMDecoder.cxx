// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaGDCMDecoder.h"

#include <filesystem>

#include <dlfcn.h>

namespace lacuna
{
namespace
{
struct Decoder
{
  decltype(&LacunaDecodeWithGDCM) Decode = nullptr;
  std::string Trouble;
};

// It stands beside the library that this is in.
std::string FindLibrary()
{
  std::string name = "libLacunaGDCMDecoder.so";
  Dl_info here{};
  // not the address of a function, which in some programs is one of their own
  static const char anchor = 0;
  if (dladdr(&anchor, &here) == 0 || !here.dli_fname)
  {
    return name;
  }
  const std::filesystem::path beside = std::filesystem::path(here.dli_fname).parent_path() / name;
  std::error_code none;
  return std::filesystem::exists(beside, none) ? beside.string() : name;
}

Decoder Load()
{
  Decoder decoder;
  void* library = dlopen(FindLibrary().c_str(), RTLD_NOW | RTLD_LOCAL); // for good
  void* found = library ? dlsym(library, "LacunaDecodeWithGDCM") : nullptr;
  if (found)
  {
    decoder.Decode = reinterpret_cast<decltype(decoder.Decode)>(found);
  }
  else
  {
    decoder.Trouble = dlerror();
  }
  return decoder;
}
}

//------------------------------------------------------------------------------
std::string DecodeWithGDCM(const CTFrame& frame, CTPixels& pixels)
{
  static const Decoder decoder = Load();
  if (!decoder.Decode)
  {
    return "cannot be decoded, since Lacuna's library for it cannot be loaded: " + decoder.Trouble;
  }
  std::string wrong;
  decoder.Decode(&frame, &pixels, &wrong);
  return wrong;
}
}

// SPDX-License-Identifier: BSD-3-Clause
// Gives the files of folders to a fuzz target, for compilers without libFuzzer:
//   FuzzXxx FOLDER...
#include "lacunaFuzzTarget.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

int main(int argc, char* argv[])
{
  int files = 0;
  for (int i = 1; i < argc; ++i)
  {
    for (const auto& entry : std::filesystem::recursive_directory_iterator(argv[i]))
    {
      if (entry.is_regular_file())
      {
        std::ifstream file(entry.path(), std::ios::binary);
        const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
        std::printf("%s\n", entry.path().filename().c_str());
        std::fflush(stdout); // the name of one that crashes
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
        ++files;
      }
    }
  }
  std::printf("%d files\n", files);
  return files > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

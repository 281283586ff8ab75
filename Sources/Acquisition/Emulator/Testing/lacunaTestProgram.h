// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// The emulator's program as users run it.
#ifndef lacunaTestProgram_h
#define lacunaTestProgram_h

#include <gtest/gtest.h>

#include <array>
#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

namespace lacunaTest
{
/// A run of the program.
class Program
{
public:
  explicit Program(std::vector<std::string> words)
  {
    int pipeEnds[2];
    EXPECT_EQ(pipe(pipeEnds), 0);
    words.insert(words.begin(), LACUNA_FASTRAK_EMULATOR);
    std::vector<char*> arguments;
    for (std::string& word : words)
    {
      arguments.push_back(word.data());
    }
    arguments.push_back(nullptr);
    this->Process = fork();
    if (this->Process == 0)
    {
      dup2(pipeEnds[1], STDOUT_FILENO);
      dup2(pipeEnds[1], STDERR_FILENO);
      close(pipeEnds[0]);
      close(pipeEnds[1]);
      execv(arguments[0], arguments.data());
      _exit(127);
    }
    close(pipeEnds[1]);
    this->Output = fdopen(pipeEnds[0], "r");
  }
  ~Program()
  {
    this->End();
    std::fclose(this->Output);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  std::string ReadLine()
  {
    std::array<char, 1000> line{};
    return std::fgets(line.data(), line.size(), this->Output) ? line.data() : "";
  }
  int End()
  {
    if (this->Process > 0)
    {
      kill(this->Process, SIGTERM);
    }
    return this->Wait();
  }
  int Wait()
  {
    int status = 0;
    if (this->Process > 0)
    {
      waitpid(this->Process, &status, 0);
      this->Process = -1;
      this->Code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }
    return this->Code;
  }

private:
  pid_t Process = -1;
  int Code = -1;
  std::FILE* Output = nullptr;
};
}
#endif

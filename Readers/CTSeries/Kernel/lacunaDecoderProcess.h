// SPDX-License-Identifier: BSD-3-Clause
/// @file
/// A process that decodes compressed pixels. A codec that aborts, loops or takes all memory ends that
/// process and not the program.
#ifndef lacunaDecoderProcess_h
#define lacunaDecoderProcess_h

#include "lacunaDecoderProtocol.h"

#include <string>

#include <sys/types.h>

namespace lacuna
{
/// The path of the program lacuna-decode. It is in a folder beside the library that this is in.
std::string FindDecoderProgram();

/// One process. It serves one thread at a time, and ends when this does.
class DecoderProcess
{
public:
  /// Throws std::runtime_error with what is wrong ("cannot be decoded: ..."). patience: seconds of the
  /// clock for the process to start, and to decode: as many again for each second of processor time that it
  /// may take. It is long, since the machine may have much else to do.
  explicit DecoderProcess(const std::string& program, double patience = 30);
  ~DecoderProcess();
  DecoderProcess(const DecoderProcess&) = delete;
  DecoderProcess& operator=(const DecoderProcess&) = delete;

  /// Decodes a stream of request.StreamBytes into request.PixelBytes pixels, and gives their format, which
  /// may be another than asked for. Where the memory holds them is set here. Returns what is wrong
  /// ("cannot be decoded ..."), or nothing.
  std::string Decode(DecoderRequest request, const unsigned char* stream, unsigned char* pixels,
    DecoderFormat& format);
  /// False after an image that ended the process.
  bool IsAlive() const { return this->Child > 0; }

private:
  // Closes itself.
  class Descriptor
  {
  public:
    ~Descriptor();
    Descriptor() = default;
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    void Set(int number);
    int Get() const { return this->Number; }

  private:
    int Number = -1;
  };

  void CheckHello();
  void Start(int socket);
  void Reserve(std::size_t size);
  // Waits so many seconds at most. False when nothing comes; then the process has ended.
  bool Receive(DecoderReply& reply, double seconds);
  void End();

  std::string Program;
  double Patience;
  Descriptor Socket;
  Descriptor Memory;
  pid_t Child = 0;
  int Status = -1;      // of waitpid when it has ended; -1: nobody knows
  bool TooLate = false; // and was ended for it
  unsigned char* Bytes = nullptr;
  std::size_t Size = 0;
};
}
#endif

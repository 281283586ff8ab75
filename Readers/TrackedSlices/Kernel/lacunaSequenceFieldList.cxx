// SPDX-License-Identifier: BSD-3-Clause
#include "lacunaSequenceFieldList.h"

#include "lacunaSequenceText.h"

#include <algorithm>
#include <set>

namespace lacuna
{
namespace
{
constexpr std::size_t LongestLine = 990; // PLUS reads 1000 characters at a time
}

//------------------------------------------------------------------------------
SequenceFieldList::SequenceFieldList(
  const SequenceKind& kind, SequenceContent& content, std::vector<std::string>& warnings)
  : Kind(kind)
  , Content(content)
  , Warnings(warnings)
{
}

//------------------------------------------------------------------------------
void SequenceFieldList::AddToHeader(const std::string& name, const std::string& text)
{
  if (this->Accepts(name, { text }, false))
  {
    this->Content.Description.CustomFields.emplace_back(name, text);
  }
}

//------------------------------------------------------------------------------
void SequenceFieldList::AddToFrames(const std::string& name, const std::vector<std::string>& texts)
{
  if (!this->Accepts(name, texts, true))
  {
    return;
  }
  for (std::size_t i = 0; i < texts.size(); ++i)
  {
    if (!texts[i].empty())
    {
      this->Content.Frames[i].emplace_back(name, texts[i]);
    }
  }
}

//------------------------------------------------------------------------------
void SequenceFieldList::RemoveFromFrames(const std::string& name)
{
  for (SequenceFields& fields : this->Content.Frames)
  {
    fields.erase(std::remove_if(fields.begin(), fields.end(),
                   [&](const auto& field) { return field.first == name; }),
      fields.end());
  }
}

//------------------------------------------------------------------------------
const std::string* SequenceFieldList::Find(std::size_t frame, const std::string& name) const
{
  const SequenceFields& fields = this->Content.Frames.at(frame);
  const auto found = std::find_if(
    fields.begin(), fields.end(), [&](const auto& field) { return field.first == name; });
  return found == fields.end() ? nullptr : &found->second;
}

//------------------------------------------------------------------------------
void SequenceFieldList::CheckLines()
{
  std::set<std::string> names;
  const auto check = [&](const SequenceFields& fields)
  {
    for (const auto& [name, text] : fields)
    {
      if (name.size() + text.size() > LongestLine)
      {
        names.insert(name);
      }
    }
  };
  check(this->Content.Description.CustomFields);
  std::for_each(this->Content.Frames.begin(), this->Content.Frames.end(), check);
  if (!names.empty())
  {
    this->Warnings.push_back("fields are longer than 1000 characters; PLUS would cut them: " +
      JoinSome({ names.begin(), names.end() }));
  }
}

//------------------------------------------------------------------------------
bool SequenceFieldList::Accepts(
  const std::string& name, const std::vector<std::string>& texts, bool ofFrame)
{
  for (const std::string& text : texts)
  {
    const std::string problem = this->Kind.GetProblem(name, text, ofFrame);
    if (!problem.empty())
    {
      this->Warnings.push_back("field '" + name + "' is not written: " + problem);
      return false;
    }
  }
  return true;
}
}

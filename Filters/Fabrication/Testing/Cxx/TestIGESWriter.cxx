// SPDX-License-Identifier: BSD-3-Clause
int TestIGESWriter(int, char*[])
{
  return 0;
}

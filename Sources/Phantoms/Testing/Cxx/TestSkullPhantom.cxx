int TestSkullPhantom(int, char*[])
{
  return 0;
}

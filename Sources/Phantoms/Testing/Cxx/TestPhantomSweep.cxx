int TestPhantomSweep(int, char*[])
{
  return 0;
}

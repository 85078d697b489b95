// A wire between browser and daemon that can be cut.

import { connect, createServer } from 'node:net';

// Carries all connections of a port of its own to the one of `url`. While it is cut, what was open is dead
// and nothing new gets through.
export async function layWire(url) {
  const { hostname, port } = new URL(url);
  const ends = new Set();
  let whole = true;
  const keep = (socket) => {
    ends.add(socket);
    socket.on('error', () => undefined);
    socket.on('close', () => ends.delete(socket));
  };
  const server = createServer((near) => {
    keep(near);
    if (!whole) return near.destroy();
    const far = connect(Number(port), hostname);
    keep(far);
    near.on('close', () => far.destroy());
    far.on('close', () => near.destroy());
    return near.pipe(far).pipe(near);
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  const cut = () => {
    whole = false;
    ends.forEach((end) => end.destroy());
  };
  return {
    url: `http://127.0.0.1:${server.address().port}`,
    cut,
    mend: () => (whole = true),
    close: () => {
      cut();
      server.close();
    },
  };
}

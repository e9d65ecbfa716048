'use strict';
/* The replay, and the buttons of the report. */
(() => {
  const place = document.getElementById('replay');
  const data = document.getElementById('replay-data');
  const note = document.getElementById('replay-note');
  const dark = matchMedia('(prefers-color-scheme: dark)');

  const drawsInSpace = () => {
    const canvas = document.createElement('canvas');
    try {
      return Boolean(canvas.getContext('webgl2') || canvas.getContext('webgl'));
    } catch {
      return false;
    }
  };

  /* Viser's own page, told what to play. What it says of graphics cards is of no use here. */
  const viewer = ({client, recording}) => {
    const told = `<script>window.__VISER_EMBED_DATA__="${recording}";`
      + `window.__VISER_EMBED_CONFIG__={darkMode:${dark.matches}};<\/script>`
      + '<style>.mantine-Notifications-root{display:none}</style>';
    const end = client.indexOf('</head>');
    return client.slice(0, end) + told + client.slice(end);
  };

  const play = () => {
    if (!drawsInSpace()) {
      note.textContent = 'This browser has no WebGL, which the replay needs. The rest of the report is whole.';
      return;
    }
    const frame = document.createElement('iframe');
    frame.sandbox.add('allow-scripts');
    frame.title = 'Replay of the run in 3D';
    frame.srcdoc = viewer(JSON.parse(data.textContent));
    place.replaceChildren(frame);
  };

  const begin = () => {
    play();
    dark.addEventListener('change', play);
  };

  if (place && data) {
    const watch = new IntersectionObserver((entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      watch.disconnect();
      if (!matchMedia('(prefers-reduced-motion: reduce)').matches) {
        begin();
        return;
      }
      const button = document.createElement('button');
      button.type = 'button';
      button.textContent = 'Play the replay';
      button.addEventListener('click', begin);
      note.replaceChildren(button);
    });
    watch.observe(place);
  }

  const say = (button, text) => {
    const before = button.textContent;
    button.textContent = text;
    setTimeout(() => { button.textContent = before; }, 2000);
  };

  /* Where the clipboard is closed to a file, the text is selected, to be copied by hand. */
  const copy = async (button) => {
    const source = document.getElementById(button.dataset.copies);
    try {
      await navigator.clipboard.writeText(source.textContent);
      say(button, 'Copied');
    } catch {
      const around = source.closest('details');
      if (around) around.open = true;
      getSelection().selectAllChildren(source);
      say(button, 'Selected: copy it with Ctrl C');
    }
  };

  const save = (button) => {
    const text = document.getElementById(button.dataset.saves).textContent;
    const address = URL.createObjectURL(new Blob([text], {type: 'application/yaml'}));
    const link = document.createElement('a');
    link.href = address;
    link.download = 'experiment.yaml';
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  };

  for (const button of document.querySelectorAll('[data-copies]')) {
    button.addEventListener('click', () => copy(button));
  }
  for (const button of document.querySelectorAll('[data-saves]')) {
    button.addEventListener('click', () => save(button));
  }
})();

'use strict';
(() => {
  // Values under the pointer. A chart says its axes in data-x and data-y: ends in values, ends in the drawing.
  const axis = (svg, name) => {
    const [low, high, from, to, log] = svg.dataset[name].split(' ');
    const scale = log ? Math.log : value => value;
    const back = log ? Math.exp : value => value;
    const [a, b] = [scale(+low), scale(+high)];
    const decimals = Math.max(0, 3 - Math.ceil(Math.log10(Math.abs(high - low))));
    return {
      name: svg.dataset[name + 'Name'],
      at: place => back(a + (place - from) / (to - from) * (b - a)),
      place: value => +from + (scale(value) - a) / (b - a) * (to - from),
      text: value => (log ? String(+value.toPrecision(3)) : value.toFixed(Math.min(decimals, 8)))
        .replace('-', '\u2212') + ' ' + svg.dataset[name + 'Unit'],
    };
  };
  const points = path => [...path.getAttribute('d').matchAll(/(-?[\d.]+) (-?[\d.]+)/g)].map(m => [+m[1], +m[2]]);
  const nearest = (list, distance) => list.reduce((a, b) => (distance(b) < distance(a) ? b : a));

  // The lines and areas of a chart at a place: colour, name, value.
  const series = (svg, x, y) => [...svg.querySelectorAll('path[data-name]')].flatMap(path => {
    const all = points(path);
    if (!all.length) return [];
    const half = path.matches('.area') ? all.length / 2 : all.length;
    const [px, py] = nearest(all.slice(0, half), p => Math.abs(p[0] - x));
    if (half === all.length) return [{ px, row: [path.getAttribute('stroke'), path.dataset.name, y.text(y.at(py))] }];
    const [, low] = nearest(all.slice(half), p => Math.abs(p[0] - px));
    const sign = y.at(py) + y.at(low) < 0 ? -1 : 1;
    return [{ px, row: [path.getAttribute('fill'), path.dataset.name, y.text(sign * (y.at(py) - y.at(low)))] }];
  });

  // The letter after an underscore is an index.
  const symbols = (parent, text) => text.split('_').forEach((part, k) => {
    if (k) parent.appendChild(document.createElement('sub')).textContent = part[0];
    parent.append(k ? part.slice(1) : part);
  });
  const box = document.body.appendChild(document.createElement('div'));
  box.className = 'readout';
  box.hidden = true;
  const lines = ['x', 'y'].map(() => document.createElementNS('http://www.w3.org/2000/svg', 'line'));
  const hide = () => { box.hidden = true; lines.forEach(line => line.remove()); };

  const inDrawing = (svg, event) => {
    const frame = svg.getBoundingClientRect();
    const scale = svg.viewBox.baseVal.width / frame.width;
    return [(event.clientX - frame.left) * scale, (event.clientY - frame.top) * scale, scale];
  };

  const show = (svg, event) => {
    let [px, py, scale] = inDrawing(svg, event);
    const [x, y] = [axis(svg, 'x'), axis(svg, 'y')];
    const [, , left, right] = svg.dataset.x.split(' ').map(Number);
    const [, , bottom, top] = svg.dataset.y.split(' ').map(Number);
    if (px < left - 6 || px > right + 6 || py < top || py > bottom) return hide();
    const found = series(svg, px, y);
    const rows = found.map(one => one.row);
    if (found.length) {
      px = found[0].px;
    } else {
      const dots = [...svg.querySelectorAll('.dot')];
      const away = dot => Math.hypot(dot.getAttribute('cx') - px, dot.getAttribute('cy') - py);
      const dot = dots.length ? nearest(dots, away) : null;
      if (dot && away(dot) < 24 * scale) {
        [px, py] = [+dot.getAttribute('cx'), +dot.getAttribute('cy')];
        // The last of those at this place lies on top.
        const note = dots.filter(other => away(other) < 0.2).pop().dataset.note;
        if (note) rows.push(['', note, '']);
      }
      rows.unshift(['', y.name, y.text(y.at(py))]);
    }
    rows.unshift(['', x.name, x.text(x.at(px))]);
    const ends = [[px, px, top, bottom], [left, right, py, py]];
    lines.forEach((line, k) => {
      line.remove();
      if (k && found.length) return;
      line.setAttribute('class', 'pointer');
      ['x1', 'x2', 'y1', 'y2'].forEach((end, n) => line.setAttribute(end, ends[k][n]));
      svg.append(line);
    });
    box.replaceChildren(...rows.map(([colour, name, value]) => {
      const row = document.createElement('div');
      if (colour) row.appendChild(document.createElement('span')).style.background = colour;
      symbols(row, name);
      row.append(' ');
      row.appendChild(document.createElement('b')).textContent = value;
      return row;
    }));
    box.hidden = false;
    const width = document.documentElement.clientWidth;
    const beside = event.clientX + 16 + box.offsetWidth > width ? event.clientX - 16 - box.offsetWidth : event.clientX + 16;
    box.style.left = Math.max(4, beside) + 'px';
    box.style.top = Math.max(4, event.clientY - box.offsetHeight - 12) + 'px';
  };
  const over = event => {
    const svg = event.target.closest && event.target.closest('svg[data-x]');
    if (svg) show(svg, event); else hide();
  };
  document.addEventListener('pointermove', over);
  document.addEventListener('pointerdown', over);
  document.addEventListener('scroll', hide, { passive: true, capture: true });
  // A finger that is lifted leaves, too: what it pointed at stays until the next touch.
  document.documentElement.addEventListener('pointerleave', event => { if (event.pointerType === 'mouse') hide(); });

  // The animation: a slider over its pictures, a choice of fields, and a mark in each chart that follows it.
  const animation = document.querySelector('.animation');
  if (!animation) return;
  const find = what => animation.querySelector(what);
  const image = find('img');
  const slider = find('input[type=range]');
  const play = find('button');
  const moments = find('.moments').textContent.trim().split('\n').map(line => line.split('\t'));
  const frames = {};
  animation.querySelectorAll('script[data-field]').forEach(data => {
    frames[data.dataset.field] = data.textContent.trim().split('\n');
  });
  const charts = [...document.querySelectorAll('svg.follows')];
  const marks = charts.map(svg => {
    const mark = svg.appendChild(document.createElementNS('http://www.w3.org/2000/svg', 'line'));
    mark.setAttribute('class', 'moment');
    const [, , bottom, top] = svg.dataset.y.split(' ');
    mark.setAttribute('y1', top);
    mark.setAttribute('y2', bottom);
    return mark;
  });
  const turn = () => {
    const chosen = find('input[type=radio]:checked');
    image.src = 'data:image/png;base64,' + frames[chosen.value][slider.value];
    image.alt = chosen.dataset.description;
    find('.span').textContent = chosen.dataset.span;
    const [at, text] = moments[slider.value];
    find('output').textContent = text;
    marks.forEach((mark, k) => {
      const place = axis(charts[k], 'x').place(+at);
      mark.setAttribute('x1', place);
      mark.setAttribute('x2', place);
    });
  };
  let timer = 0;
  const stop = () => { clearInterval(timer); timer = 0; play.textContent = 'Play'; };
  play.addEventListener('click', () => {
    if (timer) return stop();
    if (slider.value === slider.max) slider.value = 0;
    turn();
    play.textContent = 'Pause';
    timer = setInterval(() => {
      slider.value = +slider.value + 1;
      turn();
      if (slider.value === slider.max) stop();
    }, 150);
  });
  slider.addEventListener('input', () => { stop(); turn(); });
  animation.querySelectorAll('input[type=radio]').forEach(radio => radio.addEventListener('change', turn));
  charts.forEach(svg => svg.addEventListener('click', event => {
    const at = axis(svg, 'x').at(inDrawing(svg, event)[0]);
    stop();
    slider.value = nearest([...moments.keys()], k => Math.abs(moments[k][0] - at));
    turn();
  }));
  find('.controls').hidden = false;
  turn();
})();

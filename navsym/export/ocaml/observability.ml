(* The kind `observability` of docs/certificates.md: ranks of rows and their derivatives along a motion. *)

open Text
open Tree
open Ball
open Value
open Goal

(* Power series of the time: lists of balls, the constant first, all of the length [order] *)

let order = ref 1
let indices () = List.init !order Fun.id
let at l k = List.nth l k
let constant_series x = List.map (fun k -> if k = 0 then x else ball_zero) (indices ())
let is_constant = function [] -> true | _ :: l -> List.for_all is_exactly_zero l
let sum_up f l = List.fold_left (fun s k -> plus s (f k)) ball_zero l
let add = List.map2 plus

let multiply a b =
  if is_constant a then List.map (times (at a 0)) b
  else if is_constant b then List.map (fun x -> times x (at b 0)) a
  else
    let a = Array.of_list a and b = Array.of_list b in
    List.map (fun n -> sum_up (fun k -> times a.(k) b.(n - k)) (List.init (n + 1) Fun.id)) (indices ())

let slope a = List.mapi (fun k x -> times (of_int (k + 1)) x) (List.tl a) @ [ ball_zero ]

(* The series with the constant x and the derivative [rate] of what is known so far: coefficient k + 1 is rate_k/(k + 1). *)
let integrate x rate =
  let rec go done_ k =
    if k = !order then List.rev done_
    else
      let known = List.rev done_ @ List.init (!order - k) (fun _ -> ball_zero) in
      go (over (at (rate known) (k - 1)) (of_int k) :: done_) (k + 1)
  in
  go [ x ] 1

let inverse a =
  let first = over ball_one (at a 0) in
  if is_constant a then constant_series first else integrate first (fun y -> List.map minus (multiply (multiply y y) (slope a)))

let scaled q a = List.map (times (of_rational q)) a

(* a^q by p' a = q p a' *)
let power_series q a =
  let first = rational_power Whole q (at a 0) in
  if is_constant a then constant_series first
  else if is_whole q && Q.sign q > 0 then
    let rec go n = if n = 1 then a else let h = go (n / 2) in let h = multiply h h in if n land 1 = 1 then multiply h a else h in
    go (Z.to_int q.Q.num)
  else
    let rate = multiply (scaled q (slope a)) (inverse a) in
    integrate first (fun p -> multiply p rate)

let sine_and_cosine a =
  (* coefficient k + 1 of both from coefficients up to k of the other *)
  let da = slope a in
  let rec go s c k =
    if k = !order then (List.rev s, List.rev c)
    else
      let fill l = List.rev l @ List.init (!order - k) (fun _ -> ball_zero) in
      let next other = over (at (multiply (fill other) da) (k - 1)) (of_int k) in
      go (next c :: s) (minus (next s) :: c) (k + 1)
  in
  go [ sin_ball 0 (at a 0) ] [ sin_ball 1 (at a 0) ] 1

let rec function_series name a =
  let ones = constant_series ball_one and square x = multiply x x in
  let quotient x y = multiply x (inverse y) in
  let arc first rate = integrate first (fun _ -> multiply rate (slope a)) in
  let value () = one_argument Whole name (at a 0) in
  if is_constant a then constant_series (value ())
  else
    match name with
    | "exp" -> integrate (value ()) (fun y -> multiply y (slope a))
    | "log" -> arc (value ()) (inverse a)
    | "sqrt" -> power_series (Q.of_ints 1 2) a
    | "sin" -> fst (sine_and_cosine a)
    | "cos" -> snd (sine_and_cosine a)
    | "tan" -> let s, c = sine_and_cosine a in quotient s c
    | "cot" -> let s, c = sine_and_cosine a in quotient c s
    | "sec" -> inverse (snd (sine_and_cosine a))
    | "csc" -> inverse (fst (sine_and_cosine a))
    | "sinh" | "cosh" ->
        let e = function_series "exp" a in
        let f = inverse e in
        scaled (Q.of_ints 1 2) (add e (if name = "sinh" then List.map minus f else f))
    | "tanh" -> quotient (function_series "sinh" a) (function_series "cosh" a)
    | "atan" -> arc (value ()) (inverse (add ones (square a)))
    | "asin" | "acos" ->
        let rate = inverse (power_series (Q.of_ints 1 2) (add ones (List.map minus (square a)))) in
        arc (value ()) (if name = "asin" then rate else List.map minus rate)
    | "abs" -> if is_above (at a 0) then a else if is_below (at a 0) then List.map minus a else raise No_value
    | _ -> outside "%s along a motion" name

let rec series value t =
  let go = series value in
  match t with
  | Num q -> constant_series (of_rational q)
  | Pi -> constant_series (pi ())
  | Sym s -> value s
  | Sum l -> List.fold_left (fun s a -> add s (go a)) (constant_series ball_zero) l
  | Prod l -> List.fold_left (fun s a -> multiply s (go a)) (constant_series ball_one) l
  | Pow (a, b) -> (
      match !constant b with
      | Some q -> power_series q (go a)
      | None -> function_series "exp" (multiply (go b) (function_series "log" (go a))))
  | Fun ("atan2", [ y; x ]) ->
      let y = go y and x = go x in
      let turn = add (multiply x (slope y)) (List.map minus (multiply y (slope x))) in
      let rate = multiply turn (inverse (add (multiply x x) (multiply y y))) in
      integrate (atan2_ball (at y 0) (at x 0)) (fun _ -> rate)
  | Fun (name, [ x ]) -> function_series name (go x)
  | Fun (name, _) -> outside "function %s" name

(* The symbols along the motion: each round gives one coefficient more. *)
let motion rates start =
  let rec go values k =
    if k = !order then values
    else
      let value s = List.assoc s values in
      let next (s, known) =
        match List.assoc_opt s rates with
        | None -> (s, known)
        | Some rate ->
            let coefficient = over (at (series value rate) (k - 1)) (of_int k) in
            (s, List.mapi (fun i x -> if i = k then coefficient else x) known)
      in
      go (List.map next values) (k + 1)
  in
  go (List.map (fun (s, x) -> (s, constant_series x)) start) 1

(* Remainders *)

let dot row v = Sum (zero :: List.map2 (fun a b -> Prod [ a; b ]) row v)
let along rates t = Calculus.sum' (List.map (fun (s, rate) -> Calculus.product' [ Calculus.derive s t; rate ]) rates)

let remainders f h rates zeros free null =
  let rest v =
    let w = List.map2 (fun row x -> subtract (dot row v) (along rates x)) f v in
    let share (k, u) = Prod [ at w k; Pow (at u k, Num Q.minus_one) ] in
    let pairs = List.combine free null in
    let part i = Sum (zero :: List.map (fun (k, u) -> Prod [ share (k, u); at u i ]) pairs) in
    List.mapi (fun i x -> subtract x (part i)) w
  in
  List.map (along rates) zeros @ List.concat_map (fun row -> List.map (dot row) null) h @ List.concat_map rest null

let check_remainders found zeros shares =
  let check t factors =
    let part = Sum (zero :: List.map2 (fun a b -> Prod [ a; b ]) factors zeros) in
    shown "a direction that is seen, or zeros that do not stay" (Algebra.normal_form_vanishes (subtract t part))
  in
  if zeros = [] then List.iter (fun t -> check t []) found
  else begin
    same_length "shares" found shares;
    List.iter (fun row -> same_length "shares" zeros row) shares;
    List.iter2 check found shares
  end

(* The rows of H, D H, ... at the point: D a = a' + a F *)
let observed_rows value f h =
  let f = List.map (List.map (series value)) f in
  let n = List.length f in
  let next row =
    let column j = List.fold_left2 (fun s a line -> add s (multiply a (at line j))) (constant_series ball_zero) row f in
    List.init n (fun j -> add (slope (at row j)) (column j))
  in
  let rec go k row = List.map (fun a -> at a 0) row :: (if k = 1 then [] else go (k - 1) (next row)) in
  List.concat_map (fun row -> go !order (List.map (series value) row)) h

let check value ~get_matrix ~check_width ~determinant =
  match get_keys "observability" [ "kind"; "statement"; "point"; "order"; "free"; "null"; "shares"; "bits" ] value with
  | [ _; statement; point; many; free; null; shares; bits ] -> (
      match get_keys "statement" [ "F"; "H"; "rates"; "zeros"; "rank" ] statement with
      | [ f; h; rates; zeros; rank ] ->
          at_precision (get_bits 20000 bits) (fun () ->
              let point = read_numbers "point" point in
              let names = List.map fst point in
              let f = get_matrix "F" names f and h = get_matrix "H" names h in
              let n = List.length f in
              if n < 1 || n > 100 then refuse "F: expected 1 to 100 rows";
              List.iter (check_width "observability" n) [ f; h ];
              let expressions what v = List.concat (get_matrix what names (List [ v ])) in
              let read_rate (s, v) =
                if not (List.mem s names) then no_symbols s;
                (s, List.hd (expressions "rates" (List [ v ])))
              in
              let rates = List.map read_rate (get_object "rates" rates) and zeros = expressions "zeros" zeros in
              let r = get_integer "rank" 0 n rank in
              let free = List.map (get_integer "free" 0 (n - 1)) (get_list "free" free) in
              let null = get_matrix "null" names null in
              check_width "null" n null;
              if List.length free <> n - r || List.length null <> n - r then refuse "free, null: expected a list of entries";
              let shares = if zeros = [] then [] else get_matrix "shares" names shares in
              order := get_integer "order" 1 100 many;
              let is_nothing t = Algebra.key (Algebra.counted Algebra.normal t) = [] in
              let check_column i v =
                List.iteri (fun j k -> if i <> j then shown "null: two entries in a free column" (is_nothing (at v k))) free
              in
              List.iteri check_column null;
              check_remainders (remainders f h rates zeros free null) zeros shares;
              List.iter (fun z -> shown "zeros: they do not vanish at the point" (Algebra.normal_form_vanishes (put point z))) zeros;
              let start = List.map (fun (s, t) -> (s, number_ball s t)) point in
              let here s = match List.assoc_opt s start with Some x -> x | None -> no_symbols s in
              let exists t = if finite_ball here t = None then refuse "no value at the point" in
              List.iter exists (zeros @ List.concat (f @ h @ null @ shares));
              let at_point t = ball Whole here t in
              List.iter2 (fun k v -> shown "null: a free entry may be 0" (not (has_zero (at_point (at v k))))) free null;
              let moving = motion rates start in
              let along_motion s = match List.assoc_opt s moving with Some x -> x | None -> no_symbols s in
              List.iter (fun t -> ignore (series along_motion t)) (zeros @ List.concat (null @ shares));
              let w = observed_rows along_motion f h @ List.map (List.map at_point) null in
              let entry i j = List.fold_left (fun s row -> plus s (times (at row i) (at row j))) ball_zero w in
              let gram = List.init n (fun i -> List.init n (entry i)) in
              let is_regular = match determinant gram with x -> is_above x | exception No_value -> false in
              shown "the rank may be smaller" is_regular)
      | _ -> assert false)
  | _ -> assert false
